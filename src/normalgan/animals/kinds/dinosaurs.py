"""The dinosaurs by name."""

from collections.abc import Mapping

from normalgan.animals.dinosaurs import Saurian
from normalgan.animals.kinds.dinosaurs_four import SAUROPOD, STEGOSAUR, TRICERATOPS
from normalgan.animals.kinds.dinosaurs_two import RAPTOR, SPINOSAUR, TYRANNOSAUR
from normalgan.animals.plan import BodyPlan
from normalgan.animals.quadruped import Quadruped
from normalgan.animals.theropods import theropod

DINOSAURS: Mapping[str, BodyPlan] = {
    "tyrannosaur": theropod(TYRANNOSAUR),
    "raptor": theropod(RAPTOR),
    "spinosaur": theropod(SPINOSAUR),
    "sauropod": Quadruped(SAUROPOD),
    "stegosaur": Saurian(STEGOSAUR, plates=15, height=0.40, spikes=2),
    "triceratops": Saurian(TRICERATOPS, frill=0.80),
}
