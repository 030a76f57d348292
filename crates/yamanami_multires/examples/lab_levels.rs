use glam::DVec3;
use std::io::Write;
use yamanami_core::{Tin, TriangleMesh};
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let (mut p, mut t) = (vec![], vec![]);
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        match w.first() {
            Some(&"v") => p.push(DVec3::new(w[1].parse().unwrap(), w[2].parse().unwrap(), w[3].parse().unwrap())),
            Some(&"f") => t.push([1, 2, 3].map(|k: usize| w[k].parse::<u32>().unwrap() - 1)),
            _ => {}
        }
    }
    let n = t.len();
    let tin = Tin::of_mesh("", TriangleMesh::new(p, t));
    let start = std::time::Instant::now();
    let levels = yamanami_multires::tin::collapse_levels(&tin, &[n / 2, n / 4, n / 8], &Default::default());
    eprintln!("{n} triangles: {:?}", start.elapsed());
    for (k, l) in levels.iter().enumerate() {
        eprintln!("{} max {} stray {}", l.mesh.triangles.len(), l.vertical_m, l.stray_m);
        let mut f = std::fs::File::create(format!("{path}.{k}.obj")).unwrap();
        let mut s = String::new();
        for p in &l.mesh.positions {
            s += &format!("v {} {} {}\n", p.x, p.y, p.z);
        }
        for t in &l.mesh.triangles {
            s += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
        }
        f.write_all(s.as_bytes()).unwrap();
    }
}
