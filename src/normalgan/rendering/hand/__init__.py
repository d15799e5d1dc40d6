from normalgan.rendering.hand.distortion import Distortion, random_distortion
from normalgan.rendering.hand.hand import Hand

__all__ = ["Distortion", "Hand", "random_distortion"]
