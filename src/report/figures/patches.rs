//! Results of the matrix as files for other programs: patches, terms per patch, norms per bounce, form factors F.
//!
//! | file | contents |
//! |---|---|
//! | `mesh.csv` | a line per patch, in the order of the rows and columns of F, in the coordinates of the scene file; lengths in m, areas in m², radiance in W sr⁻¹ m⁻² |
//! | `mesh-terms.csv` | (T_h^k E)ᵢ per patch and k, three channels, W sr⁻¹ m⁻² |
//! | `norms.csv` | ‖T_h^k E‖ over the patches: Σ A\|x\|, √Σ A x², √Σ A x²/ρ (patches with ρ > 0), three channels each |
//! | `F.npy` | Fᵢⱼ, n × n, little-endian float32, row by row (NumPy's format 1.0) |
//!
//! Columns of `mesh.csv`:
//!
//! | column | meaning |
//! |---|---|
//! | `patch` | number of the patch, from 0 |
//! | `primitive` | number of the primitive, as counted by `fredholm info` |
//! | `front` | 1 for the side of the primitive's normal, 0 for the back |
//! | `x,y,z` | centre of mass |
//! | `area` | exact area of the part that is not covered |
//! | `nx,ny,nz` | unit normal of that side |
//! | `rho_r,…` | albedo |
//! | `E_r,…` | emitted radiance |
//! | `L_r,…` | solution of L = E + T_h L (radiosity B = π L, W m⁻²) |
//! | `corners` | "x y z" of each corner, separated by semicolons, counter-clockwise seen from that side |

use crate::operator::form_factor::FormFactors;
use crate::operator::patches::Patches;
use std::iter;

use crate::report::text::{csv::Csv, summary::BounceNorms};
use glam::DVec3;

const LETTERS: [&str; 3] = ["r", "g", "b"];

fn put(csv: &mut Csv, v: DVec3) {
    csv.put(v.x).put(v.y).put(v.z);
}

/// The contents of `mesh.csv`; `radiance` is L per patch.
pub fn mesh(patches: &Patches, radiance: &[DVec3]) -> String {
    let mut csv =
        Csv::new("patch,primitive,front,x,y,z,area,nx,ny,nz,rho_r,rho_g,rho_b,E_r,E_g,E_b,L_r,L_g,L_b,corners");
    for (i, (p, l)) in patches.iter().zip(radiance).enumerate() {
        let file = |x: DVec3| x + patches.origin();
        let corners: Vec<String> =
            p.polygon.iter().map(|c| file(*c)).map(|c| format!("{} {} {}", c.x, c.y, c.z)).collect();
        csv.put(i).put(p.primitive).put(u8::from(p.front));
        put(&mut csv, file(p.centre));
        csv.put(p.area);
        [p.normal, p.reflectance, p.emission, *l].into_iter().for_each(|v| put(&mut csv, v));
        csv.put(corners.join(";")).end();
    }
    csv.text()
}

/// The contents of `mesh-terms.csv`: a column per k and channel, `T0_r,T0_g,T0_b,T1_r,…`.
pub fn terms(terms: &[Vec<DVec3>]) -> String {
    let names = (0..terms.len()).flat_map(|k| LETTERS.map(|c| format!("T{k}_{c}")));
    let mut csv = Csv::new(&iter::once("patch".to_string()).chain(names).collect::<Vec<_>>().join(","));
    for i in 0..terms.first().map_or(0, Vec::len) {
        csv.put(i);
        terms.iter().for_each(|t| put(&mut csv, t[i]));
        csv.end();
    }
    csv.text()
}

/// The contents of `norms.csv`: a line per k.
pub fn norms(norms: &[BounceNorms]) -> String {
    let names = ["norm_1", "norm_2", "norm_w"].iter().flat_map(|n| LETTERS.map(|c| format!("{n}_{c}")));
    let mut csv = Csv::new(&iter::once("k".to_string()).chain(names).collect::<Vec<_>>().join(","));
    for n in norms {
        csv.put(n.k);
        [n.norm_1, n.norm_2, n.norm_w].into_iter().for_each(|v| put(&mut csv, v));
        csv.end();
    }
    csv.text()
}

/// The contents of `F.npy`.
pub fn npy(factors: &FormFactors) -> Vec<u8> {
    const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({0}, {0}), }}", factors.n);
    // magic bytes, two bytes of length, header and a final newline together fill whole blocks of 64 bytes
    let filled = (MAGIC.len() + 2 + header.len() + 1).next_multiple_of(64);
    header += &" ".repeat(filled - MAGIC.len() - 2 - header.len() - 1);
    header.push('\n');
    let mut out = Vec::with_capacity(filled + 4 * factors.f.len());
    out.extend_from_slice(MAGIC);
    out.extend_from_slice(&(header.len() as u16).to_le_bytes());
    out.extend_from_slice(header.as_bytes());
    factors.f.iter().for_each(|f| out.extend_from_slice(&f.to_le_bytes()));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_file_is_blocks_of_64_bytes_and_then_the_rows() {
        let f = FormFactors { n: 2, f: vec![0.0, 0.25, 1.0, -3.5], area: vec![1.0; 2], rays: 0 };
        let bytes = npy(&f);
        assert_eq!(bytes.len(), 128 + 16);
        assert_eq!(&bytes[..10], b"\x93NUMPY\x01\x00\x76\x00");
        assert!(bytes[10..128].starts_with(b"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }"));
        assert_eq!(bytes[127], b'\n');
        assert_eq!(bytes[128 + 12..], (-3.5f32).to_le_bytes());
    }
}
