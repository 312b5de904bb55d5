//! 3 × 3 matrices, for constant expressions too.

/// Three rows of three components.
pub(crate) type Matrix3 = [[f64; 3]; 3];

pub(crate) const fn apply(m: &Matrix3, v: [f64; 3]) -> [f64; 3] {
    [
        m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
        m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
        m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2],
    ]
}

pub(crate) const fn product(a: &Matrix3, b: &Matrix3) -> Matrix3 {
    transposed(&[apply(a, column(b, 0)), apply(a, column(b, 1)), apply(a, column(b, 2))])
}

pub(crate) const fn diagonal(v: [f64; 3]) -> Matrix3 {
    [[v[0], 0.0, 0.0], [0.0, v[1], 0.0], [0.0, 0.0, v[2]]]
}

pub(crate) const fn inverse(m: &Matrix3) -> Matrix3 {
    let rows = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let determinant = dot(m[0], rows[0]);
    let mut result = transposed(&rows);
    let mut i = 0;
    while i < 9 {
        result[i / 3][i % 3] /= determinant;
        i += 1;
    }
    result
}

pub(crate) const fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) const fn transposed(m: &Matrix3) -> Matrix3 {
    [column(m, 0), column(m, 1), column(m, 2)]
}

const fn column(m: &Matrix3, i: usize) -> [f64; 3] {
    [m[0][i], m[1][i], m[2][i]]
}

const fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_the_identity() {
        let m = [[0.9, 0.3, -0.2], [-0.7, 1.7, 0.04], [0.04, -0.07, 1.03]];
        let one = product(&m, &inverse(&m));
        for (i, row) in one.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-15);
            }
        }
    }
}
