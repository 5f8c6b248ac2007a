//! `--shard I/N`.

use fredholm::terms::Part;
use std::fmt;
use std::str::FromStr;

/// Part I of N, where I counts from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard(pub Part);

/// Most parts of a run.
const MOST: u32 = 100_000;

impl FromStr for Shard {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        let valid = numbers.filter(|&(i, n): &(u32, u32)| (1..=MOST).contains(&n) && (1..=n).contains(&i));
        let (i, of) = valid.ok_or_else(|| format!("`{text}` is not a part such as 3/8, the third of eight"))?;
        Ok(Self(Part { index: i - 1, of }))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.0.index + 1, self.0.of)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::Shard;

    #[test]
    fn a_part_is_one_of_several() {
        for text in ["1/1", "3/8", "8/8"] {
            assert_eq!(text.parse::<Shard>().unwrap().to_string(), text);
        }
        for text in ["0/8", "9/8", "3", "3/", "/8", "-1/8", "1/0", "a/b", "1/100001"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
