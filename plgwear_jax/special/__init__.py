"""The special functions of the two contact problems, one per file, without mechanics."""
