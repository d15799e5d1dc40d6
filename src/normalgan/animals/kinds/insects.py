"""The insects and their like."""

from collections.abc import Mapping

from normalgan.animals.insects_beetles import beetle, ladybird
from normalgan.animals.insects_crawlers import ant, caterpillar
from normalgan.animals.insects_flyers import bee, fly
from normalgan.animals.insects_leapers import grasshopper, mantis
from normalgan.animals.insects_spiders import scorpion, spider
from normalgan.animals.insects_wings import butterfly, dragonfly
from normalgan.animals.plan import BodyPlan, Form

INSECTS: Mapping[str, BodyPlan] = {
    "ant": Form(("stand", "walk"), ant),
    "bee": Form(("fly", "fly", "stand"), bee),
    "beetle": Form(("stand", "walk"), beetle),
    "butterfly": Form(("fly", "fly", "stand"), butterfly),
    "caterpillar": Form(("stand", "walk"), caterpillar),
    "dragonfly": Form(("fly", "stand"), dragonfly),
    "fly": Form(("fly", "stand", "walk"), fly),
    "grasshopper": Form(("stand", "stand", "leap"), grasshopper),
    "ladybird": Form(("stand", "walk"), ladybird),
    "mantis": Form(("stand", "strike"), mantis),
    "scorpion": Form(("stand", "walk"), scorpion),
    "spider": Form(("stand", "walk"), spider),
}
