//! The estimators of the terms by name.

use crate::math::names::list;
use std::fmt;
use std::str::FromStr;

/// The estimators of the terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// Each term from its own paths.
    Single,
    /// All terms from the prefixes of one path.
    Prefix,
    /// All terms from one particle that starts at a light.
    Light,
    /// All terms from two walks, one from each end.
    Bidirectional,
    /// A tree of paths.
    Branching {
        /// Children of every vertex.
        children: u32,
    },
}

/// Name of the random stream of an estimator, or of the path tracer if there is none, with a guide or without.
pub fn stream(estimator: Option<Estimator>, guided: bool) -> String {
    let name = estimator.map_or("path".into(), |e| e.to_string());
    if guided { format!("guided {name}") } else { name }
}

/// The end at which the walks of an estimator begin. It decides what the estimator can find, what it finds rarely, and which
/// settings it accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    /// At the eye.
    AtEye,
    /// At the lights; techniques and guides are then ignored.
    AtLight,
    /// At both ends.
    AtBoth,
}

impl Estimator {
    /// The end at which its walks begin.
    pub fn begins(self) -> Begins {
        match self {
            Self::Single | Self::Prefix | Self::Branching { .. } => Begins::AtEye,
            Self::Light => Begins::AtLight,
            Self::Bidirectional => Begins::AtBoth,
        }
    }

    /// All estimators; the tree has two children.
    pub const ALL: [Self; 5] =
        [Self::Prefix, Self::Single, Self::Branching { children: 2 }, Self::Light, Self::Bidirectional];

    /// The name, without the number of children.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Prefix => "prefix",
            Self::Light => "light",
            Self::Bidirectional => "bidirectional",
            Self::Branching { .. } => "branching",
        }
    }

    /// The same estimator, with `children` children at every vertex if it is a tree.
    #[must_use]
    pub fn with_children(self, children: u32) -> Self {
        if let Self::Branching { .. } = self { Self::Branching { children } } else { self }
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        if let Self::Branching { children } = self { write!(f, " {children}") } else { Ok(()) }
    }
}

impl FromStr for Estimator {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, children) = text.split_once(' ').unwrap_or((text, "2"));
        let found = Self::ALL.into_iter().find(|e| e.name() == name).zip(children.parse().ok());
        let known = found.map(|(e, children)| e.with_children(children));
        let known = known.filter(|e| text == e.name() || text == e.to_string());
        known.ok_or_else(|| format!("`{text}` is none of {}", list(Self::ALL.map(Self::name))))
    }
}
