//! The estimators of the terms by name.

use crate::math::names::list;
use std::fmt;
use std::str::FromStr;

/// Which estimator of the terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// Each term from paths of its own.
    Single,
    /// All terms from the prefixes of one path.
    Prefix,
    /// All terms from one particle, walked from the light.
    Light,
    /// All terms from walks from both ends.
    Bidirectional,
    /// A tree of paths.
    Branching {
        /// Children of every vertex.
        children: u32,
    },
}

/// Where the walks of an estimator begin: what it can find, what it finds rarely, and what can be asked of it follow from that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    /// At the eye.
    AtEye,
    /// At the lights; techniques and guides have no part in it.
    AtLight,
    /// At both.
    AtBoth,
}

impl Estimator {
    /// Where its walks begin.
    pub fn begins(self) -> Begins {
        match self {
            Self::Single | Self::Prefix | Self::Branching { .. } => Begins::AtEye,
            Self::Light => Begins::AtLight,
            Self::Bidirectional => Begins::AtBoth,
        }
    }

    /// All of them; the tree with two children.
    pub const ALL: [Self; 5] =
        [Self::Prefix, Self::Single, Self::Branching { children: 2 }, Self::Light, Self::Bidirectional];

    /// Its name, however many children it has.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Prefix => "prefix",
            Self::Light => "light",
            Self::Bidirectional => "bidirectional",
            Self::Branching { .. } => "branching",
        }
    }

    /// The same with so many children of every vertex, if it is a tree.
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
