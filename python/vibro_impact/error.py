"""What is wrong with what the caller gave."""


class Error(ValueError):
    """A file, a recording or a value that cannot be used; says in one line which, its value, and what is allowed."""
