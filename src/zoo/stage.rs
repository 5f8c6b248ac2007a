//! A scene that shows a mistake, or cannot: a built-in one, perhaps with a few values changed.

use crate::scene::load::{self, Options};
use crate::scene::{Description, SceneError};

/// A built-in scene with overrides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// A short name: of a folder, and in tables.
    pub label: &'static str,
    /// The built-in scene.
    pub scene: &'static str,
    /// `KEY=VALUE`, as for `--set`.
    pub set: &'static [&'static str],
}

impl Stage {
    const fn plain(scene: &'static str) -> Self {
        Self { label: scene, scene, set: &[] }
    }

    /// The Cornell box: one lamp, Lambertian.
    pub const CORNELL: Self = Self::plain("cornell");
    /// A closed box of albedo ½ that glows.
    pub const FURNACE: Self = Self::plain("furnace");
    /// The same without reflection: only emission is seen.
    pub const BLACK_ROOM: Self =
        Self { label: "furnace-black", scene: "furnace", set: &["materials.wall.reflectance=[0,0,0]"] };
    /// An integrating sphere of radius 1, lit by its cap.
    pub const SPHERE: Self = Self::plain("sphere");
    /// The same with a cap of radiance 0.2.
    pub const DIM_SPHERE: Self =
        Self { label: "sphere-dim", scene: "sphere", set: &["shapes.0.emission=[0.2,0.2,0.2]"] };
    /// The same of radius 10.
    pub const LARGE_SPHERE: Self =
        Self { label: "sphere-r10", scene: "sphere", set: &["shapes.0.radius=10", "shapes.1.radius=10"] };
    /// A mirror and a glass sphere in the Cornell box.
    pub const CORNELL_SPHERES: Self = Self::plain("cornell-spheres");
    /// A ball of glass in a sky of radiance 1.
    pub const GLASS_BALL: Self = Self::plain("glass-furnace");
    /// A cube of glass, turned, in the same sky: rays inside are reflected totally.
    pub const GLASS_CUBE: Self = Self {
        label: "glass-cube",
        scene: "glass-furnace",
        set: &[
            "shapes=[{ type = \"box\", min = [-0.6,-0.6,-0.6], max = [0.6,0.6,0.6], rotate_y = 30, material = \"glass\" }]",
        ],
    };
    /// Part of a sphere, open to a sky of radiance 1.
    pub const SKY_BOWL: Self = Self::plain("sky-bowl");
    /// 96 lamps.
    pub const MANY_LIGHTS: Self = Self::plain("many-lights");
    /// The Cornell box with a second lamp, a point.
    pub const TWO_LAMPS: Self = Self {
        label: "cornell-two-lamps",
        scene: "cornell",
        set: &["lights=[{ type = \"point\", position = [-0.4,0.5,0.5], intensity = [0.5,0.5,0.5] }]"],
    };
    /// The Cornell box with its lamp half-way down: there is light to be had behind it.
    pub const LOW_LAMP: Self =
        Self { label: "cornell-low-lamp", scene: "cornell", set: &["shapes.5.origin=[-0.23,0.5,-0.18]"] };
    /// A floor of two metres under a round lamp of radius 1 at height 1.5.
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

    /// Loads it with `width × height` pixels.
    ///
    /// # Errors
    /// None of the scenes of the zoo has any; an override that no longer fits its scene would.
    pub fn load(&self, [width, height]: [u32; 2]) -> Result<Description, SceneError> {
        let mut set: Vec<String> = self.set.iter().map(|s| (*s).to_string()).collect();
        set.push(format!("camera.size=[{width},{height}]"));
        Ok(load::scene(self.scene, &Options { set, ..Options::default() })?.description)
    }
}
