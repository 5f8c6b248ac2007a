//! Test scenes for mistakes: built-in scenes, some with a few values changed.

use crate::scene::load::{self, Options};
use crate::scene::{Description, SceneError};

/// A built-in scene with overrides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// A short name, used for folders and in tables.
    pub label: &'static str,
    /// Name of the built-in scene.
    pub scene: &'static str,
    /// Overrides `KEY=VALUE`, in the syntax of `--set`.
    pub set: &'static [&'static str],
}

impl Stage {
    const fn plain(scene: &'static str) -> Self {
        Self { label: scene, scene, set: &[] }
    }

    /// The Cornell box: one lamp, Lambertian surfaces.
    pub const CORNELL: Self = Self::plain("cornell");
    /// A closed box with albedo ½ whose walls emit light.
    pub const FURNACE: Self = Self::plain("furnace");
    /// The same box without reflection, so that only emission is seen.
    pub const BLACK_ROOM: Self =
        Self { label: "furnace-black", scene: "furnace", set: &["materials.wall.reflectance=[0,0,0]"] };
    /// An integrating sphere of radius 1; a cap of it emits light.
    pub const SPHERE: Self = Self::plain("sphere");
    /// The same sphere with a cap of radiance 0.2.
    pub const DIM_SPHERE: Self =
        Self { label: "sphere-dim", scene: "sphere", set: &["shapes.0.emission=[0.2,0.2,0.2]"] };
    /// The same sphere with radius 10.
    pub const LARGE_SPHERE: Self =
        Self { label: "sphere-r10", scene: "sphere", set: &["shapes.0.radius=10", "shapes.1.radius=10"] };
    /// A mirror and a glass sphere in the Cornell box.
    pub const CORNELL_SPHERES: Self = Self::plain("cornell-spheres");
    /// A ball of glass in a sky of radiance 1.
    pub const GLASS_BALL: Self = Self::plain("glass-furnace");
    /// A rotated glass cube in the same sky. Rays inside it are totally reflected.
    pub const GLASS_CUBE: Self = Self {
        label: "glass-cube",
        scene: "glass-furnace",
        set: &[
            "shapes=[{ type = \"box\", min = [-0.6,-0.6,-0.6], max = [0.6,0.6,0.6], rotate_y = 30, material = \"glass\" }]",
        ],
    };
    /// A part of a sphere, open to a sky of radiance 1.
    pub const SKY_BOWL: Self = Self::plain("sky-bowl");
    /// A scene with 96 lamps.
    pub const MANY_LIGHTS: Self = Self::plain("many-lights");
    /// The Cornell box with a point light as second lamp.
    pub const TWO_LAMPS: Self = Self {
        label: "cornell-two-lamps",
        scene: "cornell",
        set: &["lights=[{ type = \"point\", position = [-0.4,0.5,0.5], intensity = [0.5,0.5,0.5] }]"],
    };
    /// The Cornell box with its lamp half-way down, so that there are lit surfaces behind the lamp.
    pub const LOW_LAMP: Self =
        Self { label: "cornell-low-lamp", scene: "cornell", set: &["shapes.5.origin=[-0.23,0.5,-0.18]"] };
    /// A floor of 2 m × 2 m under a disk light of radius 1 at height 1.5.
    pub const DISK: Self = Self {
        label: "disk-over-floor",
        scene: "cornell",
        set: &[
            concat!(
                "shapes=[{ type = \"quad\", origin = [-1,-1,1], edge_u = [2,0,0], edge_v = [0,0,-2], material = \"white\" }, ",
                "{ type = \"disk\", center = [0,0.5,0], normal = [0,-1,0], radius = 1, material = \"white\", emission = [4,4,4] }]"
            ),
            "camera.origin=[0,0.2,1.9]",
            "camera.target=[0,-1,0]",
        ],
    };

    /// Loads the scene with `width × height` pixels.
    ///
    /// # Errors
    /// If an override does not fit its scene. This cannot happen with the scenes of the zoo.
    pub fn load(&self, [width, height]: [u32; 2]) -> Result<Description, SceneError> {
        let mut set: Vec<String> = self.set.iter().map(|s| (*s).to_string()).collect();
        set.push(format!("camera.size=[{width},{height}]"));
        Ok(load::scene(self.scene, &Options { set, ..Options::default() })?.description)
    }
}
