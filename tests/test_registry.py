from abc import ABC, abstractmethod
from typing import ClassVar

import pytest

from normalgan.registry import Registry


class Shape(ABC):
    @abstractmethod
    def area(self) -> float: ...


class Square(Shape):
    def area(self) -> float:
        return 1.0


@pytest.fixture
def registry() -> Registry[Shape]:
    return Registry(Shape, "normalgan.shapes")  # type: ignore[type-abstract]


def test_registers_by_class_name_and_returns_the_class(registry: Registry[Shape]) -> None:
    assert registry.register(Square) is Square
    assert registry.names() == ["Square"]
    assert list(registry) == [Square]
    registry.register(Square)  # the same class again does no harm: a module may be imported twice


def test_refuses_strangers_abstract_classes_and_duplicates(registry: Registry[Shape]) -> None:
    registry.register(Square)
    with pytest.raises(TypeError, match="int is not a subclass of Shape"):
        registry.register(int)
    with pytest.raises(TypeError, match="Shape is abstract: it does not implement area"):
        registry.register(Shape)
    with pytest.raises(ValueError, match="two classes are named Square"):
        registry.register(type("Square", (Square,), {"__module__": __name__}))


def test_a_class_that_is_defined_again_takes_the_place_of_the_first(registry: Registry[Shape]) -> None:
    for area in (1.0, 2.0):  # as a cell of a notebook does, and a module whose import failed
        again = type("Disc", (Shape,), {"area": lambda _, area=area: area, "__module__": "__main__"})
        assert registry.register(again) is registry.find("Disc")


def test_refuses_a_class_that_breaks_whoever_lists_all(registry: Registry[Shape]) -> None:
    class Named(Shape):
        name: ClassVar[str]

        @classmethod
        def sides(cls) -> int:
            return 4

    named = Registry(Named, "normalgan.named")  # type: ignore[type-abstract]
    body = {"area": lambda _: 1.0}
    with pytest.raises(TypeError, match=r"^Nameless has no name, which every Named has\.$"):
        named.register(type("Nameless", (Named,), body))
    with pytest.raises(TypeError, match=r"^Many\.sides is a tuple, but in Named it is a method\.$"):
        named.register(type("Many", (Named,), {**body, "name": "many", "sides": (1, 2)}))
    with pytest.raises(TypeError, match=r"^Flat\.area is a float, but in Shape it is a method\.$"):
        registry.register(type("Flat", (Shape,), {"area": 1.0}))


def test_a_namesake_of_another_package_can_be_imported_and_found_by_its_full_name(
    registry: Registry[Shape],
) -> None:
    registry.register(Square)
    theirs = type("Square", (Shape,), {"area": lambda _: 2.0, "__module__": "their_package.shapes"})
    assert registry.register(theirs) is theirs
    assert registry.find("Square") is Square
    assert registry.find("their_package.Square") is theirs


def test_answers_a_typo(registry: Registry[Shape]) -> None:
    registry.register(Square)
    assert registry.explain_unknown("Sqare") == "no Shape named 'Sqare'. Did you mean Square? Known: Square."
    assert registry.explain_unknown("Hexagon") == "no Shape named 'Hexagon'. Known: Square."
