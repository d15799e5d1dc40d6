from abc import ABC, abstractmethod

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
