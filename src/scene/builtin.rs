//! The built-in scenes: the files of `scenes/`, embedded in the program.

/// A scene file embedded in the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// The name on the command line.
    pub name: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// The text of `scenes/<name>.toml`.
    pub source: &'static str,
}

/// Every built-in scene; the first is the default of the program.
pub const ALL: [Builtin; 14] = [
    Builtin {
        name: "cornell",
        summary: "a Cornell box with two blocks: colour bleeding between the walls",
        source: include_str!("../../scenes/cornell.toml"),
    },
    Builtin {
        name: "furnace",
        summary: "closed; every surface emits 1 and has albedo 0.5: T^k E = 0.5^k",
        source: include_str!("../../scenes/furnace.toml"),
    },
    Builtin {
        name: "sphere",
        summary: "an integrating sphere lit by its cap: terms k ≥ 1 are constant",
        source: include_str!("../../scenes/sphere.toml"),
    },
    Builtin {
        name: "shells",
        summary: "two concentric spheres: exact terms of a 2 by 2 operator",
        source: include_str!("../../scenes/shells.toml"),
    },
    Builtin {
        name: "cornell-spheres",
        summary: "a Cornell box with a mirror and a glass sphere: caustics",
        source: include_str!("../../scenes/cornell-spheres.toml"),
    },
    Builtin {
        name: "veach-mis",
        summary: "glossy plates, lamps of equal power and different size: MIS",
        source: include_str!("../../scenes/veach-mis.toml"),
    },
    Builtin {
        name: "veach-ajar",
        summary: "a room lit through a slightly open door: a long series",
        source: include_str!("../../scenes/veach-ajar.toml"),
    },
    Builtin {
        name: "env-ggx",
        summary: "gold, copper and plastic under a sky and a point light: GGX",
        source: include_str!("../../scenes/env-ggx.toml"),
    },
    Builtin {
        name: "caustic",
        summary: "a glass sphere focuses a small lamp: hard to find from the eye",
        source: include_str!("../../scenes/caustic.toml"),
    },
    Builtin {
        name: "glass-furnace",
        summary: "a glass ball in a sky of radiance 1: every pixel sums to 1",
        source: include_str!("../../scenes/glass-furnace.toml"),
    },
    Builtin {
        name: "mirror-corridor",
        summary: "two parallel mirrors of reflectance 0.9: T^k E decays slowly",
        source: include_str!("../../scenes/mirror-corridor.toml"),
    },
    Builtin {
        name: "sky-bowl",
        summary: "part of a sphere open to a sky of radiance 1: constant terms",
        source: include_str!("../../scenes/sky-bowl.toml"),
    },
    Builtin {
        name: "many-lights",
        summary: "96 lamps from 0.01 to 10 W: light selection by power or uniform",
        source: include_str!("../../scenes/many-lights.toml"),
    },
    Builtin {
        name: "cube",
        summary: "a closed cube with an emitting ceiling: L and r(T) are known",
        source: include_str!("../../scenes/cube.toml"),
    },
];

const NAMES: [&str; ALL.len()] = {
    let mut names = [""; ALL.len()];
    let mut i = 0;
    while i < ALL.len() {
        names[i] = ALL[i].name;
        i += 1;
    }
    names
};

/// The names of the built-in scenes, in the order of [`ALL`].
pub fn names() -> &'static [&'static str] {
    &NAMES
}

/// The built-in scene with this name.
///
/// ```
/// assert!(fredholm::scene::builtin::find("cornell").is_some());
/// assert!(fredholm::scene::builtin::find("cornel").is_none());
/// ```
pub fn find(name: &str) -> Option<&'static Builtin> {
    ALL.iter().find(|b| b.name == name)
}
