"""One scene by Mitsuba 3, on one thread: a process of its own, so that its CPU time can be measured.

    by_mitsuba.py image SCENE.xml OUT.exr        the image, as the scene file asks for it
    by_mitsuba.py terms SCENE.xml OUT.npz N      mean of every term and image of their sum, for N seeds

T^k E is the difference of two images of the integrator `path`, with max_depth k + 1 and k. Both use one seed. Their paths are
then the same up to the vertex where the shorter ones end, so the difference is what path segment k + 1 adds, and its noise is
that of T^k E alone. Seeds are independent.
"""

import sys

import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

import drjit as dr
import numpy as np

K = 8


def image(scene, out):
    """Renders and writes an image."""
    dr.set_thread_count(1)
    rendered = mi.render(scene)
    dr.eval(rendered)
    dr.sync_thread()
    # images are written by a thread of the pool, of which one thread has none: the program would wait for ever
    dr.set_thread_count(2)
    mi.Bitmap(rendered).write(out)


def terms(scene, out, seeds):
    """Writes `means`, [seeds, K + 1, 3], and `sums`, [seeds, height, width, 3]."""
    dr.set_thread_count(1)
    deeper = [mi.load_dict({"type": "path", "max_depth": k + 1, "rr_depth": 1_000_000}) for k in range(K + 1)]
    means, sums = [], []
    for seed in range(seeds):
        images = [np.array(mi.render(scene, integrator=path, seed=seed), dtype=np.float64) for path in deeper]
        means.append(np.diff([i.mean((0, 1)) for i in images], axis=0, prepend=0.0))
        sums.append(images[-1])
    np.savez(out, means=means, sums=sums)


if __name__ == "__main__":
    mode, file, out, *seeds = sys.argv[1:]
    loaded = mi.load_file(file)
    if mode == "image":
        image(loaded, out)
    else:
        terms(loaded, out, int(seeds[0]))
