"""Conformance checks for authors of plug-ins; each failure is reported in one sentence.

``check(plugin)`` runs all checks on a plug-in. ``checks(HintSampler)`` returns the checks for one base
class, for ``pytest.mark.parametrize``.
"""

from normalgan.testing.conformance import Check, ConformanceError
from normalgan.testing.kinds import KINDS, check, checks

__all__ = ["KINDS", "Check", "ConformanceError", "check", "checks"]
