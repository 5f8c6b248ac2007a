//! Writes CSV: a header, then one line per record. Fields are quoted where necessary.

use std::fmt::Display;

use csv::{QuoteStyle, Writer, WriterBuilder};

/// A CSV file in memory, filled field by field.
///
/// ```
/// use fredholm::report::text::csv::Csv;
/// let mut csv = Csv::new("name,value,error");
/// csv.put("a, b").numbers([0.5, f64::NAN]).end();
/// assert_eq!(csv.text(), "name,value,error\n\"a, b\",0.5,\n");
/// ```
pub struct Csv(Writer<Vec<u8>>);

impl Csv {
    /// Starts a file with the given column names, separated by commas.
    pub fn new(header: &str) -> Self {
        Self::quoting(QuoteStyle::Necessary, header)
    }

    /// Starts a file whose fields are never quoted.
    pub(crate) fn bare(header: &str) -> Self {
        Self::quoting(QuoteStyle::Never, header)
    }

    fn quoting(style: QuoteStyle, header: &str) -> Self {
        let mut out = Self(WriterBuilder::new().quote_style(style).from_writer(Vec::new()));
        header.split(',').for_each(|name| _ = out.put(name));
        out.end();
        out
    }

    /// Adds one field.
    ///
    /// # Panics
    /// Never, because writing to memory cannot fail.
    pub fn put(&mut self, field: impl Display) -> &mut Self {
        self.0.write_field(field.to_string()).expect("memory can be written to");
        self
    }

    /// Adds numbers. A number that is not known (NaN) becomes an empty field.
    pub fn numbers(&mut self, values: impl IntoIterator<Item = f64>) -> &mut Self {
        for v in values {
            if v.is_nan() {
                self.blank(1)
            } else {
                self.put(v)
            };
        }
        self
    }

    /// Adds empty fields.
    pub fn blank(&mut self, fields: usize) -> &mut Self {
        (0..fields).for_each(|_| _ = self.put(""));
        self
    }

    /// Ends the line.
    ///
    /// # Panics
    /// If the line does not have as many fields as the header, which is a defect of the program.
    pub fn end(&mut self) {
        self.0.write_record(None::<&[u8]>).expect("every line has as many fields as the header");
    }

    /// The finished file.
    ///
    /// # Panics
    /// Never, because all fields are text.
    pub fn text(self) -> String {
        let bytes = self.0.into_inner().expect("memory can be written to");
        String::from_utf8(bytes).expect("fields are text")
    }
}
