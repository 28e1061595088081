"""Words to formal queries: the language of the product, without any store."""

from grammar.errors import Ambiguous, NotUnderstood, OutOfScope, QuestionError
from grammar.forms import Correction, FormalQuery, ObjectTerm, Relation, TimeSlice
from grammar.parser import Parsed, parse, parse_report
from grammar.vocabulary import StoreWords

__all__ = [
    "Ambiguous",
    "Correction",
    "FormalQuery",
    "NotUnderstood",
    "ObjectTerm",
    "OutOfScope",
    "Parsed",
    "QuestionError",
    "Relation",
    "StoreWords",
    "TimeSlice",
    "parse",
    "parse_report",
]
