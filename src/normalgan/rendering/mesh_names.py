"""Names of poses and variations: the name of their mesh and a number."""

__all__ = ["POSE", "VARIATION", "family", "pose_name", "variation_name"]

POSE, VARIATION = "@", "~"


def pose_name(name: str, number: int) -> str:
    """Return the name of a rig's pose.

    >>> pose_name("horse", 3)
    'horse@3'
    """
    return f"{name}{POSE}{number}"


def variation_name(name: str, number: int) -> str:
    """Return the name of a mesh's variation.

    >>> variation_name("horse@3", 1)
    'horse@3~1'
    """
    return f"{name}{VARIATION}{number}"


def family(name: str) -> str:
    """Return the name of the mesh that a pose or variation comes from; for other meshes, their own name.

    A family must not be split between training and test, because its members are nearly equal.

    >>> [family(name) for name in ("horse", "horse@3", "horse@3~1", "no. 7~old")]
    ['horse', 'horse', 'horse', 'no. 7~old']
    """
    for mark in (VARIATION, POSE):
        stem, found, number = name.rpartition(mark)
        if found and stem and number.isdecimal():
            name = stem
    return name
