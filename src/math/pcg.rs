//! The hash function from which all random numbers come: pcg4d of Jarzynski and Olano, *Hash Functions for GPU Rendering*
//! (JCGT 9(3), 2020).

#[inline(always)]
pub(super) fn pcg4d(mut v: [u32; 4]) -> [u32; 4] {
    for x in &mut v {
        *x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    }
    for round in 0..2 {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[3]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        v[3] = v[3].wrapping_add(v[1].wrapping_mul(v[2]));
        if round == 0 {
            for x in &mut v {
                *x ^= *x >> 16;
            }
        }
    }
    v
}
