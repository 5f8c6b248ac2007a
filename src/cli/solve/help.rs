//! Text below the help of `tour`, `series`, `render` and `radiosity`: examples first, then background.

/// Below `tour --help`.
pub const TOUR: &str = "Examples:
  fredholm
  fredholm tour furnace --spp 64
  fredholm tour box.toml -o box

The tour solves one scene in three ways: each bounce by its own estimator, the full path tracer, and the radiosity matrix. It \
compares the three answers with error bars and writes pictures, plots and index.html.";

/// Below `series --help`.
pub const SERIES: &str = "Examples:
  fredholm series cornell --spp 256 --max-bounces 8 --size 128x128 --seed 1
  fredholm series furnace --technique scatter --sampling cosine --spp 64 --json
  fredholm series scene.obj --emit lamp=17,12,4
  fredholm series veach-ajar --guide radiosity --time 30s --worlds terms
  fredholm series cornell --spp 4096 --crop 96,96,160,160

How k counts: k is the number of applications of T, so k = 0 is emission seen directly, k = 1 direct light, and k = 2 one \
bounce of indirect light. --max-bounces K keeps k = 0..=K; everything longer is the tail. Mitsuba renders the same images with \
max_depth = K + 1, pbrt with maxdepth = K.";

/// Below `render --help`.
pub const RENDER: &str = "Examples:
  fredholm render cornell --spp 256 --roulette constant:0.3@2
  fredholm render veach-mis --technique scatter --size 128x128

This is the path tracer of the lecture: one path per sample, and only the sum of all terms. `fredholm series` estimates every \
term separately.";

/// Below `radiosity --help`.
pub const RADIOSITY: &str = "Examples:
  fredholm radiosity cornell --patches 2400 --orders
  fredholm radiosity cornell --patches 2400 --factors both --rays 1024
  fredholm radiosity cornell --patches 130000 --rays 256
  fredholm radiosity cornell --patches 130000 --rays 256 --shard 1/8 -o 1.fsh
  fredholm radiosity cornell --patches 2000 --solver all --history history.csv
  fredholm radiosity cornell --patches 130000 --solver gmres
  fredholm radiosity cornell --solver southwell --channel green --json
  fredholm radiosity cornell --modes 8 --size 128x128
  fredholm radiosity cornell --patches 2400 --export matrix

The spectral radius is printed for the mesh and extrapolated to h → 0, with the span that the uncertainty of the order leaves. \
The extrapolation is an estimate, not a bound. It needs coarser meshes: N/4 and N/16 patches for a dense matrix, unions of 4 and \
16 patches for stored rays of at least 50000 patches.

--solver renders nothing. It writes solvers.json, solvers.svg, solvers.png, summary.json and the file of --history. The unit of \
work is one product with T; LU counts as n/3 products.

--modes solves the dense eigenproblem of every channel. It writes modes.json, modes.svg, modes.png, modes-painted.png and \
summary.json. Eigenvalues inside the band of the edges get no name, because they belong to the mesh and not to the scene.

--export also writes mesh.csv (patch, primitive, front, centre, area, normal, albedo, E, L, corners), mesh-terms.csv (T^k E of \
every patch) and norms.csv (norms of every T^k E over the patches, with exponents 1 and 2 and with weight 1/ρ, as in \
summary.json). With `matrix` it also writes F.npy, n × n float32. Units are metres and W sr⁻¹ m⁻²; the radiosity is B = π L.";
