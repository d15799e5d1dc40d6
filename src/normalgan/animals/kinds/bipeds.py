"""The bipeds, each a set of measures and what goes round the bones."""

from collections.abc import Mapping

from normalgan.animals import bipeds_heads as heads
from normalgan.animals.bipeds import Biped, Measures
from normalgan.animals.bipeds_flesh import Flesh
from normalgan.animals.bipeds_robot import robot
from normalgan.animals.plan import BodyPlan

CALM = ("stand", "stand", "walk", "sit", "wave", "arms_out")

ADULT = Biped(Measures(), Flesh(heads.human, hand="fingers", skirt=0.2))
CHILD = Biped(
    Measures(
        leg=0.40, torso=0.30, neck=0.045, head=0.19, arm=0.29, hand=0.085, foot=0.14, hips=0.052,
        shoulders=0.098, chest=(0.068, 0.090), waist=(0.066, 0.082), pelvis=(0.068, 0.088), thigh=0.050,
        calf=0.036,
        upper_arm=0.030, forearm=0.026,
    ),
    Flesh(heads.human, neck=0.033, skirt=0.35),
)  # fmt: skip
HEAVY = Biped(
    Measures(
        leg=0.44, head=0.150, shoulders=0.140, hips=0.075, chest=(0.095, 0.145), waist=(0.125, 0.150),
        pelvis=(0.115, 0.145), belly=0.045, thigh=0.078, calf=0.050, upper_arm=0.047, forearm=0.035,
    ),
    Flesh(heads.human, hand="mitt", neck=0.05),
    habits=CALM,
)  # fmt: skip
CARTOON = Biped(
    Measures(
        leg=0.25, torso=0.25, neck=0.0, head=0.36, arm=0.24, hand=0.11, foot=0.17, hips=0.055,
        shoulders=0.085,
        chest=(0.066, 0.078), waist=(0.074, 0.084), pelvis=(0.078, 0.09), thigh=0.044, calf=0.036,
        upper_arm=0.028, forearm=0.026,
    ),
    Flesh(heads.toon, neck=0.035, skirt=0.2),
    spread=0.13,
)  # fmt: skip
MONKEY = Biped(
    Measures(
        leg=0.34, torso=0.30, neck=0.03, head=0.19, arm=0.42, hand=0.12, foot=0.16, hips=0.05,
        shoulders=0.092,
        chest=(0.068, 0.082), waist=(0.06, 0.07), pelvis=(0.062, 0.074), thigh=0.042, calf=0.029,
        upper_arm=0.028, forearm=0.025, stoop=12.0, crouch=14.0,
    ),
    Flesh(heads.monkey, hand="fingers", foot="paw", neck=0.04, tail=0.55),
    habits=CALM,
)  # fmt: skip
GORILLA = Biped(
    Measures(
        leg=0.32, torso=0.38, neck=0.0, head=0.24, arm=0.52, hand=0.15, foot=0.19, hips=0.085, shoulders=0.19,
        chest=(0.14, 0.185), waist=(0.12, 0.14), pelvis=(0.11, 0.13), belly=0.03, thigh=0.082, calf=0.056,
        upper_arm=0.07, forearm=0.062, stoop=20.0, crouch=18.0,
    ),
    Flesh(heads.gorilla, hand="fingers", foot="paw", neck=0.11, coat=(0.003, 0.05)),
    habits=CALM,
)  # fmt: skip
STANDING_BEAR = Biped(
    Measures(
        leg=0.36, torso=0.44, neck=0.03, head=0.24, arm=0.32, hand=0.12, foot=0.19, hips=0.095,
        shoulders=0.155,
        chest=(0.14, 0.155), waist=(0.155, 0.17), pelvis=(0.14, 0.155), belly=0.03, thigh=0.098, calf=0.07,
        upper_arm=0.068, forearm=0.058, stoop=4.0, crouch=6.0,
    ),
    Flesh(heads.bear, hand="paw", foot="paw", neck=0.11, coat=(0.003, 0.06)),
    habits=CALM,
)  # fmt: skip
ROBOT = Biped(
    Measures(
        leg=0.42, head=0.19, arm=0.36, hand=0.11, foot=0.19, hips=0.085, shoulders=0.185, chest=(0.09, 0.13),
        waist=(0.07, 0.1), pelvis=(0.075, 0.115), thigh=0.05, calf=0.05, upper_arm=0.04, forearm=0.04,
    ),
    robot,
    spread=0.16,
)  # fmt: skip

BIPEDS: Mapping[str, BodyPlan] = {
    "adult": ADULT,
    "cartoon": CARTOON,
    "child": CHILD,
    "gorilla": GORILLA,
    "heavy": HEAVY,
    "monkey": MONKEY,
    "robot": ROBOT,
    "standing_bear": STANDING_BEAR,
}
