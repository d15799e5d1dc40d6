"""The plush toys."""

from collections.abc import Mapping

from normalgan.animals.plan import BodyPlan, Form
from normalgan.animals.plush import HABITS
from normalgan.animals.plush_dragon import dragon
from normalgan.animals.plush_farm import elephant, frog, pig
from normalgan.animals.plush_pets import bunny, cat, teddy
from normalgan.animals.plush_sea import octopus, penguin

PLUSH: Mapping[str, BodyPlan] = {
    "plush_bunny": Form(HABITS, bunny),
    "plush_cat": Form(HABITS, cat),
    "plush_dragon": Form(HABITS, dragon),
    "plush_elephant": Form(HABITS, elephant),
    "plush_frog": Form(HABITS, frog),
    "plush_octopus": Form(HABITS, octopus),
    "plush_penguin": Form(HABITS, penguin),
    "plush_pig": Form(HABITS, pig),
    "teddy": Form(HABITS, teddy),
}
