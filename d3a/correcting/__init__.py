"""What people say of a store later: names, corrections, what is to be forgotten, undo."""
