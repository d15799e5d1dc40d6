"""Names of what is made of a mesh: its poses and its variations bear its own name and a number."""

__all__ = ["POSE", "VARIATION", "family", "pose_name", "variation_name"]

POSE, VARIATION = "@", "~"


def pose_name(name: str, number: int) -> str:
    """Return what a pose of a rig is called.

    >>> pose_name("horse", 3)
    'horse@3'
    """
    return f"{name}{POSE}{number}"


def variation_name(name: str, number: int) -> str:
    """Return what a variation of a mesh is called.

    >>> variation_name("horse@3", 1)
    'horse@3~1'
    """
    return f"{name}{VARIATION}{number}"


def family(name: str) -> str:
    """Return the name of the mesh that a pose or a variation was made of, and of any other mesh its own.

    One family must not be split between training and test: its members are nearly alike.

    >>> [family(name) for name in ("horse", "horse@3", "horse@3~1", "no. 7~old")]
    ['horse', 'horse', 'horse', 'no. 7~old']
    """
    for mark in (VARIATION, POSE):
        stem, found, number = name.rpartition(mark)
        if found and stem and number.isdecimal():
            name = stem
    return name
