//! The scenes that travel inside the binary: the files of `scenes/`, one constant each.

/// A scene file embedded in the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// What the command line calls it.
    pub name: &'static str,
    /// One line on what it shows.
    pub summary: &'static str,
    /// The text of `scenes/<name>.toml`.
    pub source: &'static str,
}

/// Every built-in scene; the first is the default of the program.
pub const ALL: [Builtin; 4] = [
    Builtin {
        name: "cornell",
        summary: "a Cornell box of quads and two blocks, colours bleeding",
        source: include_str!("../../scenes/cornell.toml"),
    },
    Builtin {
        name: "furnace",
        summary: "a closed box where every surface glows and reflects half: T^k E = 0.5^k everywhere",
        source: include_str!("../../scenes/furnace.toml"),
    },
    Builtin {
        name: "sphere",
        summary: "an integrating sphere lit by its own cap: every term from k = 1 on is constant",
        source: include_str!("../../scenes/sphere.toml"),
    },
    Builtin {
        name: "shells",
        summary: "two concentric spheres: pointwise exact terms of a 2 by 2 operator, with occlusion",
        source: include_str!("../../scenes/shells.toml"),
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

/// The built-in scene of that name.
///
/// ```
/// assert!(fredholm::scene::builtin::find("cornell").is_some());
/// assert!(fredholm::scene::builtin::find("cornel").is_none());
/// ```
pub fn find(name: &str) -> Option<&'static Builtin> {
    ALL.iter().find(|b| b.name == name)
}
