"""Writes the binary USD seeds from the text one: seeds/usd/square.usdc and seeds/usd/square.usdz.

    python tests/fuzz/usd_seeds.py

Needs usd-core (PyPI). A seed written anew may differ in its bytes; the tests that read seeds do not depend on them.
"""

from pathlib import Path

from pxr import Sdf, UsdUtils

SEEDS = Path(__file__).resolve().parent / "seeds" / "usd"
layer = Sdf.Layer.FindOrOpen(str(SEEDS / "square.usda"))
# Lists of 16 numbers or more are compressed.
mesh = layer.GetPrimAtPath("/Shirt/Front")
widths = Sdf.AttributeSpec(mesh, "primvars:widths", Sdf.ValueTypeNames.FloatArray)
widths.default = [1.0, 2.0] * 12
numbers = Sdf.AttributeSpec(mesh, "primvars:numbers", Sdf.ValueTypeNames.IntArray)
numbers.default = list(range(24))
layer.customLayerData = {"tool": {"name": "seed", "sizes": {"M": 1.5}}}
layer.Export(str(SEEDS / "square.usdc"))
assert UsdUtils.CreateNewUsdzPackage(str(SEEDS / "square.usdc"), str(SEEDS / "square.usdz"))
