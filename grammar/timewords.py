"""Words of time: which words may stand in a spoken time, and the terminals of time.lark they are.

A word that has another use (may, second, sun, spring) becomes a time word by its neighbours only.
"""

from __future__ import annotations

from grammar.closed import words_of

WEEKDAYS = ["monday", "tuesday", "wednesday", "thursday", "friday", "saturday", "sunday"]
WEEKDAY_SHORT = {
    "mon": 0, "tue": 1, "tues": 1, "wed": 2, "weds": 2, "thu": 3, "thur": 3, "thurs": 3,
    "fri": 4, "sat": 5, "sun": 6, "wensday": 2, "wendsday": 2, "toosday": 1,
}  # fmt: skip
"""Weekdays shortened, or spelled as they sound, too far from their name for a slip of it."""
MONTHS = [
    "january",
    "february",
    "march",
    "april",
    "may",
    "june",
    "july",
    "august",
    "september",
    "october",
    "november",
    "december",
]
MONTH_SHORT = {
    "jan": 1, "feb": 2, "mar": 3, "apr": 4, "jun": 6, "jul": 7, "aug": 8, "sep": 9, "sept": 9,
    "oct": 10, "nov": 11, "dec": 12,
}  # fmt: skip
MONTH_NUMBER = {**{name: n + 1 for n, name in enumerate(MONTHS)}, **MONTH_SHORT}
WEEKDAY_NUMBER = {**{name: n for n, name in enumerate(WEEKDAYS)}, **WEEKDAY_SHORT}
SHY = frozenset(("may", "march", "mar", "sun", "sat", "mon", "wed", "jan", "dec", "fri"))
"""Names of days and months that are also other words: they need a neighbour that says time."""

UNITS = {
    "second": "second", "seconds": "second", "sec": "second", "secs": "second",
    "minute": "minute", "minutes": "minute", "min": "minute", "mins": "minute",
    "hour": "hour", "hours": "hour", "hr": "hour", "hrs": "hour", "h": "hour", "wk": "week",
    "day": "day", "days": "day", "week": "week", "weeks": "week", "fortnight": "fortnight",
    "fortnights": "fortnight", "month": "month", "months": "month", "year": "year",
    "years": "year", "decade": "decade", "decades": "decade", "night": "day", "nights": "day",
    "weekend": "week", "weekends": "week",
}  # fmt: skip
PARTS = {
    "morning": "morning", "mornings": "morning", "afternoon": "afternoon", "evening": "evening",
    "night": "night", "nighttime": "night", "daytime": "day", "midday": "midday",
    "lunchtime": "lunch", "lunch": "lunch", "breakfast": "breakfast", "dinnertime": "dinner",
    "dinner": "dinner", "teatime": "tea", "bedtime": "bedtime", "dawn": "dawn", "dusk": "dusk",
    "sunrise": "dawn", "sunset": "dusk", "noontime": "midday", "sunup": "dawn", "sundown": "dusk",
    "daybreak": "dawn", "nightfall": "dusk", "twilight": "dusk", "supper": "dinner",
    "suppertime": "dinner", "brunch": "brunch", "nighttimes": "night", "evenings": "evening",
    "afternoons": "afternoon",
}  # fmt: skip
FIXED_CLOCKS = {"noon": 12, "midnight": 24, "midday": 12, "mid-day": 12}
HOLIDAYS = {
    "christmas eve": (12, 24), "christmas day": (12, 25), "christmas": (12, 25),
    "boxing day": (12, 26), "new year's eve": (12, 31), "new years eve": (12, 31),
    "new year's day": (1, 1), "new years day": (1, 1), "new year": (1, 1), "new year's": (1, 1),
    "halloween": (10, 31), "valentine's day": (2, 14), "valentines day": (2, 14),
    "independence day": (7, 4), "veterans day": (11, 11), "st patrick's day": (3, 17),
    "saint patrick's day": (3, 17), "april fools": (4, 1), "groundhog day": (2, 2),
    "labour day": (5, 1), "may day": (5, 1), "epiphany": (1, 6), "all saints day": (11, 1),
    "martin luther king day": (0, 1), "presidents day": (0, 2), "mother's day": (0, 3),
    "mothers day": (0, 3), "memorial day": (0, 4), "father's day": (0, 5), "fathers day": (0, 5),
    "labor day": (0, 6), "columbus day": (0, 7), "thanksgiving day": (0, 8),
    "thanksgiving": (0, 8), "black friday": (0, 9), "easter sunday": (0, 10), "easter": (0, 10),
    "good friday": (0, 11), "easter monday": (0, 12),
}  # fmt: skip
"""Holiday -> (month, day), or (0, rule number of calendar.moving_holiday)."""
DECADES = {
    "twenties": 20, "thirties": 30, "forties": 40, "fifties": 50, "sixties": 60, "seventies": 70,
    "eighties": 80, "nineties": 90,
}  # fmt: skip
"""Decades by their last two digits: the last such one gone by."""
SEASONS = {"spring": 3, "summer": 6, "autumn": 9, "fall": 9, "winter": 12}

LINKS = words_of(
    "at on in of the during within throughout for whole entire , exactly precisely sharp "
    "promptly sometime over"
)
LEADS_DAY = words_of("on since until till before after by from")
INTRODUCES_HOUR = words_of(
    "at by before after since until till til between from to and around about than - "
    "through approximately roughly past exactly"
)
PHRASES: dict[str, tuple[str, object]] = {
    "the day before yesterday": ("DAYS", 2),
    "day before yesterday": ("DAYS", 2),
    "day before last": ("DAYS", 2),
    "before last": ("_BEFORE_LAST", 0),
    **{f"{unit} to date": ("CURRENT", unit) for unit in ("week", "month", "quarter", "year")},
    "yesterday": ("DAYS", 1),
    "yesterday's": ("DAYS", 1),
    "today": ("DAYS", 0),
    "today's": ("DAYS", 0),
    **dict.fromkeys(("this time", "this same time"), ("SAME", 0)),
    "tonight": ("PARTDAY", "tonight"),
    "last night": ("PARTDAY", "last night"),
    "yesterday night": ("PARTDAY", "yesterday night"),
    "the night before last": ("PARTDAY", "night before last"),
    "last evening": ("PARTDAY", "yesterday evening"),
    "last afternoon": ("PARTDAY", "yesterday afternoon"),
    "last morning": ("PARTDAY", "yesterday morning"),
    "overnight": ("PARTDAY", "last night"),
    **dict.fromkeys(
        (
            "the wee hours",
            "the small hours",
            "the early hours",
            "the early hours of the morning",
            "the small hours of the morning",
            "the wee hours of the morning",
            "the early hours of",
            "the small hours of",
            "the wee hours of",
        ),
        ("PART", "small hours"),
    ),
    **dict.fromkeys(("after dark", "after nightfall"), ("PART", "tonight")),
    **dict.fromkeys(("first thing", "first thing in the"), ("EDGE", "early")),
    "the dead of": ("LINK", "dead of"),
    **dict.fromkeys(("the crack of", "the break of"), ("LINK", "crack of")),
    **dict.fromkeys(("on the dot", "on the nose"), ("LINK", "sharp")),
    "this morning": ("PARTDAY", "this morning"),
    "this afternoon": ("PARTDAY", "this afternoon"),
    "this evening": ("PARTDAY", "this evening"),
    "this night": ("PARTDAY", "tonight"),
    "right now": ("NOW", 0),
    "just now": ("NOW", 0),
    "now": ("NOW", 0),
    "at the moment": ("NOW", 0),
    "at this moment": ("NOW", 0),
    "at present": ("NOW", 0),
    "currently": ("NOW", 0),
    "presently": ("NOW", 0),
    "between": ("_BETWEEN", 0),
    "since": ("_SINCE", 0),
    "ever since": ("_SINCE", 0),
    "starting": ("_SINCE", 0),
    "as of": ("_SINCE", 0),
    **dict.fromkeys(("compared to", "compared with"), ("_SINCE", 0)),
    "until": ("_UNTIL", 0),
    "up until": ("_UNTIL", 0),
    "up to": ("_UNTIL", 0),
    "till": ("_UNTIL", 0),
    "til": ("_UNTIL", 0),
    "by": ("_UNTIL", 0),
    "no later than": ("_UNTIL", 0),
    "before": ("_BEFORE", 0),
    "earlier than": ("_BEFORE", 0),
    "sooner than": ("_BEFORE", 0),
    "prior to": ("_BEFORE", 0),
    "previous to": ("_BEFORE", 0),
    "more than": ("_BEFORE", 0),
    "longer than": ("_BEFORE", 0),
    "after": ("_AFTER", 0),
    "later than": ("_AFTER", 0),
    "past": ("_AFTER", 0),
    "following": ("_AFTER", 0),
    "no earlier than": ("_SINCE", 0),
    **dict.fromkeys(("on or after", "at or after", "after or on", "from or after"), ("_SINCE", 0)),
    **dict.fromkeys(("on or before", "at or before", "before or on"), ("_UNTIL", 0)),
    **dict.fromkeys(
        ("on", "onward", "onwards", "forward", "and after", "and later", "and on"), ("_ONWARD", 0)
    ),
    **dict.fromkeys(("day before", "the day before"), ("_DAY_EARLIER", 0)),
    **dict.fromkeys(("day after", "the day after"), ("_DAY_LATER", 0)),
    **{
        f"the {unit} {side}": ("SPAN_BEFORE", f"{unit} {side}")
        for unit in ("week", "weekend", "night", "evening", "morning", "afternoon")
        for side in ("before", "after")
    },
    **dict.fromkeys(("week of", "the week of"), ("WHOLE", "week")),
    **dict.fromkeys(("weekend of", "the weekend of"), ("WHOLE", "weekend")),
    **dict.fromkeys(("month of", "the month of", "the day of"), ("LINK", "month of")),
    "less than": ("_AFTER", 0),
    "not more than": ("_AFTER", 0),
    "around": ("_AROUND", 0),
    "about": ("_AROUND", 0),
    "approximately": ("_AROUND", 0),
    "roughly": ("_AROUND", 0),
    "circa": ("_AROUND", 0),
    "nearly": ("_AROUND", 0),
    "almost": ("_AROUND", 0),
    "close to": ("_AROUND", 0),
    "or so": ("LINK", "or so"),
    "or": ("_OR", 0),
    "ish": ("_ISH", 0),
    **dict.fromkeys(("ago", "ago today"), ("_AGO", 0)),
    "back": ("_AGO", 0),
    "earlier": ("_AGO", 0),
    "early": ("EDGE", "early"),
    "late": ("EDGE", "late"),
    "the beginning of": ("EDGE", "early"),
    "beginning of": ("EDGE", "early"),
    "the start of": ("EDGE", "early"),
    "start of": ("EDGE", "early"),
    "the end of": ("EDGE", "late"),
    "end of": ("EDGE", "late"),
    "the middle of": ("EDGE", "mid"),
    "middle of": ("EDGE", "mid"),
    "mid": ("EDGE", "mid"),
    "o'clock": ("_OCLOCK", 0),
    "oclock": ("_OCLOCK", 0),
    "o clock": ("_OCLOCK", 0),
    "weekend": ("WEEKEND", 0),
    **dict.fromkeys(
        (
            "some time",
            "at some point",
            "at some stage",
            "at any time",
            "at any point",
            "at any moment",
            "anytime",
            "any time",
            "one day",
            "at one point",
            "at some time",
        ),
        ("LINK", "some time"),
    ),
    **dict.fromkeys(
        (
            "shortly after",
            "right after",
            "just after",
            "soon after",
            "a little after",
            "a bit after",
        ),
        ("_AFTER", 0),
    ),
    **dict.fromkeys(
        ("shortly before", "right before", "just before", "a little before", "a bit before"),
        ("_BEFORE", 0),
    ),
    "during the day": ("PART", "day"),
    "dinner time": ("PART", "dinner"),
    "lunch time": ("PART", "lunch"),
    "tea time": ("PART", "tea"),
    "breakfast time": ("PART", "breakfast"),
    "week before last": ("BACK", "week"),
    "month before last": ("BACK", "month"),
    "year before last": ("BACK", "year"),
    "weekend before last": ("BACK", "weekend"),
    "and": ("_AND", 0),
    "from": ("_FROM", 0),
    "to": ("_TO", 0),
    "through": ("_TO", 0),
    "thru": ("_TO", 0),
    "-": ("_TO", 0),
    "last": ("_LAST", 0),
    "previous": ("_LAST", 0),
    "this past": ("_LAST", 0),
    "this last": ("_LAST", 0),
    "this": ("_THIS", 0),
    "the current": ("_THIS", 0),
    "current": ("_THIS", 0),
    "earlier this": ("_THIS", 0),
    "later last": ("_LAST", 0),
    "earlier last": ("_LAST", 0),
    "later this": ("_THIS", 0),
    "earlier in the": ("_THIS", 0),
    "later in the": ("_THIS", 0),
    "earlier today": ("DAYS", 0),
    "earlier in the day": ("DAYS", 0),
    "later in the day": ("DAYS", 0),
    "later today": ("DAYS", 0),
    "earlier yesterday": ("DAYS", 1),
    "and a half": ("_HALF", 0),
    "one and a half": ("COUNT", 1.5),
    "a couple of": ("COUNT", 2),
    "couple of": ("COUNT", 2),
    "couple": ("COUNT", 2),
    "a couple": ("COUNT", 2),
    "a few": ("COUNT", 3),
    "few": ("COUNT", 3),
    "several": ("COUNT", 3),
    "some": ("COUNT", 3),
    "half an": ("COUNT", 0.5),
    "half a": ("COUNT", 0.5),
    "a half": ("COUNT", 0.5),
    "half of an": ("COUNT", 0.5),
    "half": ("COUNT", 0.5),
    "a quarter of an": ("COUNT", 0.25),
    "quarter of an": ("COUNT", 0.25),
    "a quarter": ("COUNT", 0.25),
    "quarter": ("COUNT", 0.25),
    "three quarters of an": ("COUNT", 0.75),
    "three quarter": ("COUNT", 0.75),
    "three quarters of": ("COUNT", 0.75),
    "a": ("COUNT", 1),
    "an": ("COUNT", 1),
}
