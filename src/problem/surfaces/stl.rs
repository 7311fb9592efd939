//! Triangles of STL files, in text and binary form.

use crate::math::Vec3;

/// Bytes of a binary file before its number of triangles, and before its triangles.
const HEADER: usize = 80;
const BEFORE: usize = 84;
/// Bytes of a triangle: normal, three vertices, and two more.
const OF_TRIANGLE: usize = 50;

/// Three vertices.
pub type Triangle = [Vec3<f64>; 3];

/// What was found, and what was expected.
pub type Refused = (String, &'static str);

/// The triangles of a file.
pub fn triangles(bytes: &[u8]) -> Result<Vec<Triangle>, Refused> {
    let count = bytes.get(HEADER..BEFORE).map(|own| number(own) as usize);
    let is_binary = count.is_some_and(|count| {
        let size = count.checked_mul(OF_TRIANGLE);
        size.and_then(|size| size.checked_add(BEFORE)) == Some(bytes.len())
    });
    let found = match (is_binary, std::str::from_utf8(bytes)) {
        (true, _) => binary(&bytes[BEFORE..]),
        (false, Ok(text)) if text.trim_start().starts_with("solid") => of_text(text)?,
        (false, _) => {
            let found = match count {
                Some(count) => format!("{} bytes for {count} triangles", bytes.len()),
                None => format!("{} bytes", bytes.len()),
            };
            let expected = "an STL file: \"solid\" and facets in words, or 84 bytes and 50 more for each triangle";
            return Err((found, expected));
        }
    };
    for (k, triangle) in found.iter().enumerate() {
        if !triangle.iter().flatten().all(|own| own.is_finite()) {
            let found = format!("a coordinate that is not finite, of triangle {}", k + 1);
            return Err((found, "finite coordinates"));
        }
    }
    match found.is_empty() {
        true => Err(("no triangle".to_owned(), "a closed surface")),
        false => Ok(found),
    }
}

/// An unsigned number of four bytes, the lowest first.
fn number(bytes: &[u8]) -> u32 {
    (0..4).fold(0, |sum, k| sum | (u32::from(bytes[k]) << (8 * k)))
}

fn binary(bytes: &[u8]) -> Vec<Triangle> {
    let coordinate = |triangle: &[u8], k: usize| {
        let at = 4 * k;
        f64::from(f32::from_bits(number(&triangle[at..at + 4])))
    };
    // The first three coordinates are those of the normal.
    let vertex = |triangle: &[u8], v: usize| {
        Vec3::from([0, 1, 2].map(|i| coordinate(triangle, 3 + 3 * v + i)))
    };
    let all = bytes.chunks_exact(OF_TRIANGLE);
    all.map(|own| [0, 1, 2].map(|v| vertex(own, v))).collect()
}

fn of_text(text: &str) -> Result<Vec<Triangle>, Refused> {
    let mut found = Vec::new();
    let mut open: Vec<Vec3<f64>> = Vec::new();
    let mut inside = false;
    for (k, line) in text.lines().enumerate() {
        let wrong = |expected| Err((format!("\"{}\" on line {}", line.trim(), k + 1), expected));
        let mut words = line.split_whitespace();
        match words.next().unwrap_or("") {
            "vertex" => {
                let all: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
                match <[f64; 3]>::try_from(all) {
                    Ok(own) if inside && open.len() < 3 => open.push(Vec3::from(own)),
                    Ok(_) => return wrong("three vertices in a facet"),
                    Err(_) => return wrong("\"vertex\" and three numbers"),
                }
            }
            "facet" if !inside => inside = true,
            "facet" => return wrong("\"endfacet\" before another facet"),
            "endfacet" => match <Triangle>::try_from(std::mem::take(&mut open)) {
                Ok(triangle) if inside => {
                    found.push(triangle);
                    inside = false;
                }
                _ => return wrong("three vertices in a facet"),
            },
            "solid" | "outer" | "endloop" | "endsolid" | "" => {}
            _ => return wrong("a line of an STL file"),
        }
    }
    match inside {
        true => Err(("the end of the text".to_owned(), "\"endfacet\"")),
        false => Ok(found),
    }
}
