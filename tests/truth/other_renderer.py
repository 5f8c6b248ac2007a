"""Terms of a scene by another renderer: Mitsuba 3 (Wenzel Jakob and others, 2022).

    T^k E = mean over paths of  Σ  β (w_s + w_c)      per k, where β is the throughput of a path through the pixel

Mitsuba reads the numbers of the same scene file and supplies rays, intersections, BSDFs (values, densities, samples),
emitters and their sampling, and the camera. The walk below joins them as its own integrator `path` does: next-event
estimation and scattering, weighed by the balance heuristic, without roulette; only that every length is kept apart.
`--check` compares with `path` itself, whose images of max_depth k + 1 and k differ by T^k E.

Every batch has a seed of its own. Standard errors are those of the mean of the batches.

To run it again (Python 3.11, pip install mitsuba==3.9.1 numpy; the variants llvm_* need an LLVM library of version 16
or later, named by DRJIT_LIBLLVM_PATH where it is not found), from the root of the repository:

    python tests/truth/other_renderer.py > tests/truth/other_renderer.json
    python tests/truth/other_renderer.py --check scenes/cornell-spheres.toml 32x32
"""

import json, math, sys, tomllib
from pathlib import Path

import numpy as np
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import drjit as dr

K = 6
T = mi.ScalarTransform4f


# the scene

def rgb(v):
    return {"type": "rgb", "value": [float(x) for x in v]}


def f_in(eta):
    """Share of diffuse light that the inside of a boundary reflects, exactly: 1 - (1 - F_out)/eta²."""
    mu, w = np.polynomial.legendre.leggauss(400)
    mu, w = 0.5 * (mu + 1), 0.5 * w
    t = np.sqrt(1 - (1 - mu**2) / eta**2)
    f = 0.5 * (((mu - eta * t) / (mu + eta * t)) ** 2 + ((eta * mu - t) / (eta * mu + t)) ** 2)
    return 1 - (1 - 2 * np.sum(w * mu * f)) / eta**2


def f_in_fitted(eta):
    """The same as Mitsuba takes it for its smooth plastic: the fit of Egan and Hilgeman (1973)."""
    return -1.4399 / eta**2 + 0.7099 / eta + 0.6681 + 0.0636 * eta


def colour(m, folder):
    if "texture" in m:  # v from the top there, from the bottom here
        turn = mi.ScalarTransform3f().translate([0, 1]).scale([1, -1])
        image = {"filter_type": "bilinear", "wrap_mode": "repeat", "to_uv": turn}
        return {"type": "bitmap", "filename": str(folder / m["texture"]), **image}
    return rgb(m["reflectance"])


def material(m, folder):
    kind, alpha = m["type"], m.get("alpha")
    rough = {"distribution": "ggx", "alpha": alpha, "sample_visible": True} if alpha else {}
    # Mitsuba has no other masking; where it is not asked for, fredholm must be told: --set materials.X.masking=separable
    if kind == "diffuse":
        b = {"type": "diffuse", "reflectance": colour(m, folder)}
    elif kind == "mirror":
        b = {"type": "conductor", "material": "none", "specular_reflectance": rgb(m["reflectance"])}
    elif kind == "conductor":
        metal = (
            {"material": "none", "specular_reflectance": rgb(m["reflectance"])}
            if "reflectance" in m
            else {"eta": rgb(m["eta"]), "k": rgb(m["k"])}
        )
        b = {"type": "roughconductor" if alpha else "conductor", **metal, **rough}
    elif kind == "dielectric":
        b = {"type": "roughdielectric" if alpha else "dielectric", "int_ior": m["ior"], "ext_ior": m.get("ior_outside", 1.0)}
        return {**b, **rough}
    elif kind == "plastic":
        eta = m.get("ior", 1.5)
        rho = np.array(m["reflectance"])
        if not alpha:  # ρ that has under the fitted F_in the base ρ/(1 - ρ F_in) of the exact one
            base = rho / (1 - rho * f_in(eta))
            rho = base / (1 + base * f_in_fitted(eta))
        # under a rough coat it takes another F_in: 0.552 for α = 0.1 and η = 1.5, where 1 - T̄/η² is 0.590
        b = {"type": "roughplastic" if alpha else "plastic", "int_ior": eta, "ext_ior": 1.0, "nonlinear": True}
        b = {**b, **rough, "diffuse_reflectance": rgb(rho)}
    return b if m.get("sides") == "front" else {"type": "twosided", "bsdf": b}


def frame(x, y, z, at):
    return T(np.array([[x[i], y[i], z[i], at[i]] for i in range(3)] + [[0, 0, 0, 1]], dtype=float))


def quad(origin, u, v):
    o, u, v = (np.array(a, dtype=float) for a in (origin, u, v))
    n = np.cross(u, v)
    return {"type": "rectangle", "to_world": frame(u / 2, v / 2, n / np.linalg.norm(n), o + u / 2 + v / 2)}


def shapes(s):
    """The shapes of one entry, and their area."""
    kind = s["type"]
    if kind == "quad":
        return [quad(s["origin"], s["edge_u"], s["edge_v"])], float(np.linalg.norm(np.cross(s["edge_u"], s["edge_v"])))
    if kind == "sphere":
        one = {"type": "sphere", "center": s["center"], "radius": s["radius"], "flip_normals": s.get("inward", False)}
        return [one], 4 * math.pi * s["radius"] ** 2
    if kind == "disk":
        n = np.array(s["normal"], dtype=float) / np.linalg.norm(s["normal"])
        x = np.cross(n, [1, 0, 0] if abs(n[0]) < 0.5 else [0, 1, 0])
        x /= np.linalg.norm(x)
        r = s["radius"]
        return [{"type": "disk", "to_world": frame(r * x, r * np.cross(n, x), n, s["center"])}], math.pi * r * r
    if kind == "box":
        lo, hi, a = np.array(s["min"], float), np.array(s["max"], float), math.radians(s.get("rotate_y", 0))
        turn = np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
        half, mid = (hi - lo) / 2, (hi + lo) / 2
        faces = []
        for axis in range(3):
            for sign in (-1, 1):
                e = np.eye(3)
                u, v = 2 * half[(axis + 1) % 3] * e[(axis + 1) % 3], 2 * half[(axis + 2) % 3] * e[(axis + 2) % 3]
                u, v = (u, v) if (sign > 0) != s.get("inward", False) else (v, u)
                corner = sign * half[axis] * e[axis] - u / 2 - v / 2
                faces.append(quad(mid + turn @ corner, turn @ u, turn @ v))
        return faces, 8 * (half[0] * half[1] + half[1] * half[2] + half[2] * half[0])
    raise ValueError(kind)


def light(entry, folder):
    if entry["type"] == "point":
        return {"type": "point", "position": entry["position"], "intensity": rgb(entry["intensity"])}
    if entry["type"] == "directional":
        return {"type": "directional", "direction": entry["direction"], "irradiance": rgb(entry["irradiance"])}
    if "radiance" in entry:
        return {"type": "constant", "radiance": rgb(np.array(entry["radiance"]) * entry.get("scale", 1))}
    # Mitsuba's map begins at -z where ours has its middle, and both turn counter-clockwise seen from +y
    turn = T().rotate([0, 1, 0], 180 + entry.get("rotate", 0))
    return {"type": "envmap", "filename": str(folder / entry["file"]), "scale": entry.get("scale", 1.0), "to_world": turn}


def load(path, size=None):
    path = Path(path)
    d = tomllib.loads(path.read_text())
    c, folder = d["camera"], path.parent
    w, h = size or c["size"]
    scene = {
        "type": "scene",
        "sensor": {
            "type": "perspective",
            "fov": c["fov"],
            "fov_axis": "x",
            "to_world": T().look_at(c["origin"], c["target"], c["up"]),
            "film": {"type": "hdrfilm", "width": w, "height": h, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        },
    }
    for name, m in d["materials"].items():
        scene["m_" + name] = {**material(m, folder), "id": "m_" + name}
    for i, s in enumerate(d["shapes"]):
        parts, area = shapes(s)
        emitted = s.get("emission") or (np.array(s["power"]) / (math.pi * area) if "power" in s else None)
        for j, part in enumerate(parts):
            part["bsdf"] = {"type": "ref", "id": "m_" + s["material"]}
            if emitted is not None:
                part["emitter"] = {"type": "area", "radiance": rgb(emitted)}
            scene[f"s_{i}_{j}"] = part
    for i, entry in enumerate(d.get("lights", [])):
        scene[f"l_{i}"] = light(entry, folder)
    return mi.load_dict(scene), (w, h)


# the walk

def batch(scene, size, spp, seed):
    """Sums over the samples of each pixel, [K + 1, pixels, 3]."""
    w, h = size
    n = w * h * spp
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, n)
    pixel = dr.arange(mi.UInt32, n) // spp
    u = sampler.next_2d()
    at = mi.Point2f((mi.Float(pixel % w) + u.x) / w, (mi.Float(pixel // w) + u.y) / h)
    ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, at, mi.Point2f(0.5))
    beta, active = mi.Spectrum(1.0), mi.Bool(True)
    before, density, delta = dr.zeros(mi.Interaction3f, n), mi.Float(0), mi.Bool(True)
    context = mi.BSDFContext()
    sums = [[dr.zeros(mi.Float, w * h) for _ in range(3)] for _ in range(K + 1)]

    def score(k, value):
        for c in range(3):
            dr.scatter_reduce(dr.ReduceOp.Add, sums[k][c], value[c], pixel)

    for k in range(K + 1):
        si = scene.ray_intersect(ray, active)
        # found by scattering
        emitter = si.emitter(scene)
        ds = mi.DirectionSample3f(scene, si, before)
        other = scene.pdf_emitter_direction(before, ds, active & ~delta)
        weight = dr.select(delta, 1.0, density / (density + other))
        score(k, dr.select(active, beta * weight * emitter.eval(si, active), 0.0))
        if k == K:
            break
        active &= si.is_valid()
        bsdf = si.bsdf()
        # found by connecting
        lit = active & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
        ds, emitted = scene.sample_emitter_direction(si, sampler.next_2d(), True, lit)
        lit &= ds.pdf != 0
        f, pdf = bsdf.eval_pdf(context, si, si.to_local(ds.d), lit)
        weight = dr.select(ds.delta, 1.0, ds.pdf / (ds.pdf + pdf))
        score(k + 1, dr.select(lit, beta * f * emitted * weight, 0.0))
        # the next direction
        bs, factor = bsdf.sample(context, si, sampler.next_1d(), sampler.next_2d(), active)
        beta = dr.select(active, beta * factor, 0.0)
        ray = si.spawn_ray(si.to_world(bs.wo))
        before, density = mi.Interaction3f(si), bs.pdf
        delta = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
        active &= dr.max(beta) != 0
        dr.eval(ray, beta, before, density, delta, active, sums, sampler)
    dr.eval(sums)
    return np.array([[np.array(c, dtype=np.float64) for c in term] for term in sums]).transpose(0, 2, 1)


def terms(scene, size, spp, batches, seed=0):
    """Pixel means of every batch, [batches, K + 1, h, w, 3]."""
    w, h = size
    all = [batch(scene, size, spp, seed * 100_000 + b) / spp for b in range(batches)]
    return np.array(all).reshape(batches, K + 1, h, w, 3)


def regions(images, n):
    """Means over n × n equal tiles, [batches, K + 1, n * n, 3]."""
    b, k, h, w, _ = images.shape
    return images.reshape(b, k, n, h // n, n, w // n, 3).mean((3, 5)).reshape(b, k, n * n, 3)


def summary(images, n):
    """Mean and standard error of the image and its tiles, [K + 1, 1 + n * n, 3]."""
    values = np.concatenate([regions(images, 1), regions(images, n)], 2)
    return values.mean(0), values.std(0, ddof=1) / math.sqrt(len(values))


def check(path, size):
    scene, size = load(path, size)
    images = terms(scene, size, 512, 32)
    mean, error = (x[:, 0] for x in summary(images, 1))
    last = 0
    for k in range(K + 1):
        path_of = lambda s: mi.render(scene, integrator=whole, spp=512, seed=1000 * k + s + 1)
        whole = mi.load_dict({"type": "path", "max_depth": k + 1, "rr_depth": 1000})
        means = np.array([np.array(path_of(s), dtype=np.float64).mean((0, 1)) for s in range(16)])
        m, e = means.mean(0), means.std(0, ddof=1) / 4
        z = (mean[: k + 1].sum(0) - m) / np.hypot(e, images.mean((2, 3))[:, : k + 1].sum(1).std(0, ddof=1) / math.sqrt(32))
        print(f"Σ to {k}: {mean[: k + 1].sum(0)} path {m} z {z}")


SCENES = [  # file, size, samples per pixel and batch, batches
    ("scenes/cornell-spheres.toml", (32, 32), 1024, 48),
    ("tests/scenes/metals.toml", (32, 32), 1024, 48),
    ("tests/scenes/coats.toml", (32, 32), 1024, 48),
    ("tests/scenes/lamps.toml", (32, 32), 1024, 48),
    ("tests/scenes/tiles.toml", (32, 32), 1024, 48),
]


def references():
    out = []
    for path, size, spp, batches in SCENES:
        scene, size = load(path, size)
        mean, error = summary(terms(scene, size, spp, batches), 2)
        digits = lambda a: [[[float(f"{x:.6g}") for x in c] for c in t] for t in a]
        out.append({
            "id": Path(path).stem,
            "inputs": {"scene": path, "size": size, "replicates": batches},
            "expected": {"mean": digits(mean), "std_error": digits(error)},
            "how_verified": f"Mitsuba {mi.__version__} (Jakob et al. 2022), the walk of its integrator path with every "
            f"length apart, {batches} batches of {spp} samples per pixel with seeds 0 to {batches - 1}; the image, then "
            "its four quadrants row by row; errors are those of the mean of the batches",
        })
    print("[\n" + ",\n".join(json.dumps(o) for o in out) + "\n]")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--check"]:
        check(sys.argv[2], tuple(int(x) for x in sys.argv[3].split("x")))
    else:
        references()
