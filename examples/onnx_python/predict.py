"""Predicts the normal map of a drawing with an exported model, using only ONNX Runtime, NumPy and Pillow.

python predict.py MODEL.onnx DRAWING.png NORMAL.png
"""

import sys

import numpy as np
import onnxruntime
from PIL import Image

model, drawing, target = sys.argv[1:]
session = onnxruntime.InferenceSession(model, providers=["CPUExecutionProvider"])
size = session.get_inputs()[0].shape[-1]

# The drawing has dark lines on white paper and one object that fills the frame. Ink is 1 and paper 0.
paper = Image.open(drawing).convert("L").resize((size, size), Image.Resampling.BOX)
sketch = 1 - np.asarray(paper, np.float32)[None, None] / 255

# Hints: the normals at the hinted pixels, then a channel with 1 there. Here the middle faces the viewer.
hints = np.zeros((1, 4, size, size), np.float32)
hints[0, :, size // 2, size // 2] = 0, 0, 1, 1

normal = session.run(["normal"], {"sketch": sketch, "hints": hints})[0][0].transpose(1, 2, 0)
length = np.linalg.norm(normal, axis=-1, keepdims=True)
flat = np.array([0, 0, 1], np.float32)  # off the object, as engines expect
normal = np.where(length > 0.5, normal / np.maximum(length, 1e-6), flat)
Image.fromarray(np.rint((normal + 1) / 2 * 255).astype(np.uint8)).save(target)
