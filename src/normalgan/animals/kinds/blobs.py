"""Compound blobs, without a name and with one."""

from collections.abc import Mapping

from normalgan.animals.blobs import blob, creature
from normalgan.animals.blobs_cars import car
from normalgan.animals.blobs_craft import boat, plane, rocket
from normalgan.animals.blobs_garden import house, snowman
from normalgan.animals.blobs_mushrooms import mushroom
from normalgan.animals.blobs_plants import cactus, fir, tree
from normalgan.animals.blobs_vessels import mug, teapot, vase
from normalgan.animals.plan import BodyPlan, Form

STILL = ("rest",)

BLOBS: Mapping[str, BodyPlan] = {
    "blob": Form(STILL, blob),
    "boat": Form(STILL, boat),
    "cactus": Form(STILL, cactus),
    "car": Form(STILL, car),
    "creature": Form(STILL, creature),
    "fir": Form(STILL, fir),
    "house": Form(STILL, house),
    "mug": Form(STILL, mug),
    "mushroom": Form(STILL, mushroom),
    "plane": Form(STILL, plane),
    "rocket": Form(STILL, rocket),
    "snowman": Form(STILL, snowman),
    "teapot": Form(STILL, teapot),
    "tree": Form(STILL, tree),
    "vase": Form(STILL, vase),
}
