"""The scenes of the comparison."""

import tomllib
from dataclasses import dataclass, field

import numpy as np
from programs import OUT, ROOT


@dataclass
class Case:
    """A scene, and what is found out about it."""

    name: str
    scene: str
    sets: list = field(default_factory=list)
    timed: bool = True
    remarks: list = field(default_factory=list)  # what is changed on both sides
    notes: list = field(default_factory=list)  # what Mitsuba models differently, by the exporter
    error: str = ""
    rounds: list = field(default_factory=list)
    result: dict = field(default_factory=dict)

    @property
    def folder(self):
        return OUT / "work" / self.name.replace(" ", "-")

    def differing(self):
        """The k at which the programs differ."""
        by_k = enumerate(self.result.get("terms", []))
        return [k for k, channels in by_k if any(c["differs"] for c in channels)]


def mesh():
    """A scene file: the walls and the lamp of `cornell` around a bumpy sphere of 93 744 triangles, as in benches/paths.rs."""
    text = (ROOT / "scenes/cornell.toml").read_text()
    walls = text.partition("[[shapes]] # 6")[0]
    rows, columns = 218, 216
    v, u = np.meshgrid(np.pi * np.arange(rows + 1) / rows, 2 * np.pi * np.arange(columns) / columns, indexing="ij")
    r = 0.6 + 0.05 * np.sin(7 * u) * np.sin(9 * v) * np.sin(v)
    x, y, z = r * np.sin(v) * np.cos(u), r * np.cos(v) - 0.3, r * np.sin(v) * np.sin(u)
    number = lambda i, j: i * columns + j % columns + 1
    lines = ["v {:.9g} {:.9g} {:.9g}".format(*p) for p in zip(x.flat, y.flat, z.flat)]
    for i in range(rows):
        for j in range(columns):
            a, b, c, d = number(i, j), number(i, j + 1), number(i + 1, j), number(i + 1, j + 1)
            lines += [f"f {a} {b} {d}"] * (i > 0) + [f"f {a} {d} {c}"] * (i + 1 < rows)
    folder = OUT / "work"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "bumps.obj").write_text("\n".join(lines) + "\n")
    shape = '[[shapes]]\ntype = "obj"\nfile = "bumps.obj"\nmaterial = "white"\n'
    (folder / "mesh.toml").write_text(walls.replace('name = "cornell"', 'name = "mesh"') + shape)
    return str(folder / "mesh.toml")


def separable(case):
    """Mitsuba's microfacets mask separately on both sides of a reflection: the scene gets the same masking on both sides."""
    file = ROOT / f"scenes/{case.scene}.toml"
    materials = tomllib.loads(file.read_text())["materials"] if file.exists() else {}
    rough = [name for name, m in materials.items() if "alpha" in m and m.get("masking") != "separable"]
    for name in rough:
        case.sets += ["--set", f"materials.{name}.masking=separable"]
    if rough:
        case.remarks.append("separable masking in both")


def cases():
    all = [Case(name, name) for name in ["cornell", "cornell-spheres", "env-ggx", "veach-mis", "many-lights"]]
    plain = Case("env-ggx without plastic", "env-ggx", ["--set", "shapes.5.material=copper50"], timed=False)
    plain.remarks.append("copper instead of plastic in both")
    all.insert(3, plain)
    for case in all:
        separable(case)
    return all + [Case("mesh", "")]
