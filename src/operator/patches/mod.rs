//! The surfaces of a scene divided into patches: the basis functions of the discrete operator.
//!
//! ```text
//! L ≈ Σᵢ Lᵢ 1_{Pᵢ}        Pᵢ convex, flat, of nearly equal area, restricted to what is uncovered
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | Pᵢ | patch: one side of one cell of a surface | [`Patch::polygon`] |
//! | Aᵢ | area of the true surface of the patch that no other surface covers, m² | [`Patch::area`] |
//! | Aᵢᶠ | area of the flat polygon, m² | [`Patch::flat_area`] |
//! | ρᵢ, Eᵢ | albedo and emitted radiance | [`SurfaceSide::reflectance`], [`SurfaceSide::emission`] |
//! | A | area of all reflecting sides, covered or not | [`Patches::surface_area`] |
//!
//! Flat primitives are first cut along the lines where others touch or cross them. A block on the floor therefore cuts its
//! footprint out of the floor (after Baum, Mann, Smith and Winget 1991, "Making radiosity usable"). Spheres and disks become
//! flat facets, each with the area of the true surface.

mod body;
mod brute_force;
mod choose;
mod cover;
mod curved;
mod finder;
mod grading;
mod locate;
mod near;
mod patch;
mod segments;
mod tree;

pub use crate::math::polygon;
use crate::scene::{Description, Primitive, SceneError, description::Sides};
pub use brute_force::{BruteForce, Hit};
use choose::Search;
use cover::{Cover, CoverTest};
use glam::DVec3;
pub(crate) use locate::Lookup;
use patch::sides_of;
pub use patch::{Corners, Patch, SurfacePoint, SurfaceSide};
pub(crate) use segments::{LANES, Lane, Segments};
use std::sync::Arc;

/// All patches of a scene. They are numbered by primitive; within a primitive, those of its front come before those of its
/// back.
#[derive(Clone, Debug)]
pub struct Patches {
    list: Vec<Patch>,
    primitives: Vec<Primitive>,
    indices: Vec<Index>,
    surface_area: f64,
    covered_area: f64,
    cover: CoverTest,
    origin: DVec3,
}

/// Marks a cell side without a patch, because it is covered or does not reflect.
const NONE: u32 = u32::MAX;

/// The cells of a primitive, and the number of the patch on each side of each cell.
#[derive(Clone, Debug)]
struct Index {
    search: Search,
    patch: [Vec<u32>; 2],
}

impl Patches {
    /// Divides the scene into about `n` patches of nearly equal area: at least one per uncovered side, six per disk and
    /// eighteen per sphere. Their points are relative to the middle of the scene ([`Patches::origin`]), as those of
    /// [`Scene`](crate::scene::Scene) are.
    ///
    /// ```
    /// use fredholm::{operator::patches::Patches, scene::description::*};
    /// use glam::DVec3;
    /// let camera = CameraDescription { origin: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, fov: 40.0, size: [8, 8] };
    /// let grey = Material::diffuse("grey", DVec3::splat(0.5), Sides::Front);
    /// let geometry = Geometry::Box { min: DVec3::ZERO, max: DVec3::ONE, rotate_y: 0.0, inward: true };
    /// let room = Shape { name: "room".into(), geometry, material: 0, emission: DVec3::ONE };
    /// let scene = Description { name: "furnace".into(), camera, materials: vec![grey], shapes: vec![room], lights: vec![], expect: None };
    /// let patches = Patches::new(&scene, 96)?;
    /// assert_eq!(patches.len(), 96);
    /// assert_eq!(patches.surface_area(), 6.0);
    /// # Ok::<(), fredholm::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// If `n` is zero, nothing reflects, a surface has no area, or a shape names a material that does not exist. Also if the
    /// scene has surfaces that are not Lambertian or lights that are not surfaces ([`Description::radiosity_suits`]).
    pub fn new(scene: &Description, n: usize) -> Result<Self, SceneError> {
        Self::graded(scene, n, 1.0)
    }

    /// Divides the scene into about `n` patches that are narrower near the edges where faces meet: at the distance d from an
    /// edge, the width across the edge is proportional to d^{1 − 1/grading}. A grading of 1 divides evenly; 2 is enough for
    /// eigenvalues with an error of order h². Quadrilaterals are graded, both whole faces and pieces of faces. Triangles,
    /// pieces with more corners, spheres and disks keep cells of equal area.
    ///
    /// # Errors
    /// The errors of [`Patches::new`], and an error if `grading` is not in [1, 8].
    pub fn graded(scene: &Description, n: usize, grading: f64) -> Result<Self, SceneError> {
        if !(1.0..=8.0).contains(&grading) {
            return Err(SceneError::new(format!("the grading {grading} is not in the range 1 to 8"))
                .help("give a number from 1 to 8"));
        }
        if n == 0 {
            return Err(SceneError::new("a mesh needs at least one patch, but 0 were requested")
                .help("ask for at least one patch"));
        }
        let crate::scene::centre::Centred { scene, origin, .. } = scene.centred();
        let scene = &scene;
        let surfaces = scene.surfaces();
        let listed = &surfaces.list;
        suits(scene, listed)?;
        let sides = |s: usize| scene.materials[scene.shapes[s].material].sides;
        let primitives: Vec<(Primitive, Sides)> = listed.iter().map(|&(s, p)| (p, sides(s))).collect();
        let cover = CoverTest::new(primitives.clone(), &surfaces.overlaps);

        // cut, classify, and only then divide, so that covered regions get no patches
        let regions = choose::regions(&primitives, &cover, grading, 2.0 * surfaces.moved);
        let a = choose::cell_area(&regions, n);

        let mut patches = Self {
            list: Vec::new(),
            primitives: primitives.iter().map(|p| p.0).collect(),
            indices: Vec::new(),
            surface_area: primitives.iter().map(|(p, s)| p.area() * sides_of(*s).count() as f64).sum(),
            covered_area: 0.0,
            cover,
            origin,
        };
        for (number, region) in regions.into_iter().enumerate() {
            let (s, p) = listed[number];
            let shape = region.divide(&p, a);
            let mut patch = [Vec::new(), Vec::new()];
            for side in sides_of(sides(s)) {
                let front = side == 0;
                let owner = &scene.shapes[s];
                let shared = Arc::new(SurfaceSide {
                    primitive: number,
                    front,
                    ball: match p {
                        Primitive::Sphere { center, radius, .. } => Some((center, radius)),
                        _ => None,
                    },
                    reflectance: scene.materials[owner.material].lambertian().unwrap_or_default(),
                    emission: if front { owner.emission } else { DVec3::ZERO },
                });
                for cell in shape.cells() {
                    patch[side].push(NONE);
                    let whole = Patch::new(&shared, cell.polygon.to_vec(), cell.area);
                    let free = match cell.cover[side] {
                        Cover::Free => 1.0,
                        Cover::Covered => 0.0,
                        Cover::Mixed => patches.cover.free_share(number, &whole.polygon, 8, |x| whole.lift(x)),
                    };
                    patches.covered_area += (1.0 - free) * cell.area;
                    if free > 0.0 {
                        patch[side][cell.number] = patches.list.len() as u32;
                        patches.list.push(Patch { area: free * cell.area, ..whole });
                    }
                }
            }
            patches.indices.push(Index { search: shape.finder(), patch });
        }
        if patches.list.is_empty() {
            return Err(SceneError::new(
                "no surface of the scene can receive light: each is covered or faces only black backs",
            )
            .help("check which sides of the surfaces reflect"));
        }
        Ok(patches)
    }

    /// Returns true if another surface covers this point of patch `i`, so that the point neither emits nor reflects.
    pub fn is_covered(&self, i: usize, at: SurfacePoint) -> bool {
        self.cover.is_covered(self.list[i].primitive, at)
    }

    /// Sets the reflectance of each patch to 0 in the channels in which light never reaches it; `lit` tells per patch and
    /// channel whether light does. No light is reflected there in either case. Afterwards T is the operator restricted to
    /// the patches that light reaches.
    pub fn darken(&mut self, lit: &[[bool; 3]]) {
        let mut made: std::collections::HashMap<(*const SurfaceSide, [bool; 3]), Arc<SurfaceSide>> =
            std::collections::HashMap::new();
        for (patch, lit) in self.list.iter_mut().zip(lit).filter(|(_, lit)| **lit != [true; 3]) {
            let old = patch.side.clone();
            let side = made.entry((Arc::as_ptr(&old), *lit)).or_insert_with(|| {
                let keep = DVec3::from_array(lit.map(|l| f64::from(u8::from(l))));
                Arc::new(SurfaceSide { reflectance: old.reflectance * keep, ..(*old).clone() })
            });
            patch.side = side.clone();
        }
    }

    /// A mesh twice as coarse: [`Patches::unions`] of up to four patches each.
    pub fn parents(&self) -> Vec<u32> {
        self.unions(4)
    }

    /// A coarser mesh: each of its patches is the union of up to `most` neighbours on one side of one flat surface. Returns
    /// for every patch the number of its union. Patches of curved surfaces are not united.
    pub fn unions(&self, most: usize) -> Vec<u32> {
        let mut parent = vec![0; self.list.len()];
        let mut next = 0;
        for index in &self.indices {
            for cells in index.patch.iter().filter(|p| !p.is_empty()) {
                let mut number = std::collections::BTreeMap::new();
                for (patch, group) in cells.iter().zip(index.search.groups(cells.len(), most)).filter(|c| *c.0 != NONE)
                {
                    let fresh = next + number.len() as u32;
                    parent[*patch as usize] = *number.entry(group).or_insert(fresh);
                }
                next += number.len() as u32;
            }
        }
        parent
    }

    /// The origin of the patch coordinates, in the coordinates of the scene file, m.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Always false: [`Patches::new`] returns an error for a scene without patches.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Area of all reflecting sides, covered or not, m². A sensor that samples all surfaces divides by this area.
    pub fn surface_area(&self) -> f64 {
        self.surface_area
    }

    /// Σ Aᵢ xᵢ / A: the mean over all reflecting sides, where covered parts count as zero.
    pub fn surface_mean(&self, x: &[DVec3]) -> DVec3 {
        self.iter().zip(x).map(|(p, x)| p.area * *x).sum::<DVec3>() / self.surface_area
    }

    /// Area of the reflecting sides that belongs to no patch because it is covered, m².
    pub fn covered_area(&self) -> f64 {
        self.covered_area
    }

    /// The primitives on which the patches lie: those of [`Description::surfaces`].
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// The areas Aᵢ of all patches, m².
    pub fn areas(&self) -> Vec<f64> {
        self.list.iter().map(|p| p.area).collect()
    }
}

/// Returns an error if a radiosity matrix cannot represent these surfaces.
fn suits(scene: &Description, listed: &[(usize, Primitive)]) -> Result<(), SceneError> {
    if listed.is_empty() {
        return Err(
            SceneError::new("the scene has no surface, so there is nothing to divide into patches").help("add a shape")
        );
    }
    if !scene.lights.is_empty() {
        let e = SceneError::new(
            "the scene has lights that are not surfaces, and a radiosity matrix knows only light emitted by surfaces",
        )
        .key("lights");
        return Err(e.help("run without radiosity, or replace these lights by emitting shapes"));
    }
    for &(s, p) in listed {
        let shape = &scene.shapes[s];
        if shape.material >= scene.materials.len() {
            return Err(SceneError::new(format!("material {} does not exist", shape.material)).key(&shape.name));
        }
        let material = &scene.materials[shape.material];
        if material.lambertian().is_none() {
            let e = SceneError::new("a radiosity matrix can only hold Lambertian surfaces of one colour");
            return Err(e
                .key(format!("materials.{}", material.name))
                .help("run without radiosity, or use a Lambertian material without texture"));
        }
        if !(p.area() > 0.0 && p.area().is_finite()) {
            let what = format!(
                "a surface of the shape {} has the area {} m², which is not a positive number",
                shape.name,
                p.area()
            );
            return Err(SceneError::new(what).key(&shape.name).help("remove the shape or correct its size"));
        }
    }
    Ok(())
}

impl std::ops::Deref for Patches {
    type Target = [Patch];
    fn deref(&self) -> &[Patch] {
        &self.list
    }
}
