"""Conformance checks for authors of plug-ins; each failure is one sentence.

``check(plugin)`` runs all checks of the plug-in's kind; ``checks(HintSampler)`` lists the checks of a kind
for ``pytest.mark.parametrize``.
"""

from normalgan.testing.conformance import Check, ConformanceError
from normalgan.testing.kinds import KINDS, check, checks

__all__ = ["KINDS", "Check", "ConformanceError", "check", "checks"]
