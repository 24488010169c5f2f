"""The special functions of the two contact problems, one a file; nothing of mechanics in them."""
