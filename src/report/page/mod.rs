//! The report of a run as one page.
//!
//! ```text
//! data → codes → script → html
//! ```
//!
//! | part | place |
//! |---|---|
//! | numbers and images of a run, as the page reads them | [`data`] |
//! | images as bytes | [`codes`] |
//! | the scripts that draw them | [`script`], folder `script/` |
//! | the page | [`html`], `view.html`, `page.css` |

pub mod codes;
pub mod data;
pub mod gallery;
pub mod html;
pub mod script;
mod tables;
