"""Which packages of npm the site takes, each by version and digest, and what for."""

from __future__ import annotations

from reports.site.packages import Package

KATEX = Package(
    "katex",
    "0.19.1",
    "jG8uKntjSEcm2EpQOh0XturpPuuC9r3Sq5HLHdsFdWZT27E672SF19QEi+of0/YeOy15lDgRhKvr5614uRrEfA==",
    "MIT",
    "turns formulas into MathML while the site is built; no part of it is in the site",
    (("dist/katex.mjs", ""),),
)
D3 = Package(
    "d3",
    "7.9.2",
    "ZKb/mONPVKzaO5UlcWcwN8bS4ezvQaYu+bsou+XgNABdGC800kwH651ADTbbTxMPHW13UlvbQafdmJQDk1w7Mg==",
    "ISC",
    "scales and axes of the charts",
    (("dist/d3.min.js", "packages/d3.min.js"), ("LICENSE", "packages/d3.LICENSE.txt")),
)
PLOT = Package(
    "@observablehq/plot",
    "0.6.17",
    "/qaXP/7mc4MUS0s4cPPFASDRjtsWp85/TbfsciqDgU1HwYixbSbbytNuInD8AcTYC3xaxACgVX06agdfQy9W+g==",
    "ISC",
    "the charts of stored rows",
    (("dist/plot.umd.min.js", "packages/plot.min.js"), ("LICENSE", "packages/plot.LICENSE.txt")),
)
MUJOCO = Package(
    "@mujoco/mujoco",
    "3.14.0",
    "WPUYidu4Fx8+uM4hQv80SOA0ifpWGrsNJguKs8JBV8SCTxjKQ2/rqsh880nUH0/Vwa8vuefghvCQkkoed3bkUg==",
    "Apache-2.0",
    "the engine MuJoCo, compiled to WebAssembly by its maintainers",
    (("mujoco.js", "packages/mujoco.js"), ("mujoco.wasm", "packages/mujoco.wasm")),
)
