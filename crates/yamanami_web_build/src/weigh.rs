//! What the viewer weighs on its way to a browser: each file as it is, by gzip and by Brotli.

use std::io::Write as _;
use std::path::Path;

/// Sizes of one file, bytes.
struct Weight {
    raw: usize,
    gzip: usize,
    brotli: usize,
}

/// A table of the wasm, everything else, and the sum.
pub(crate) fn table(folder: &Path) -> Result<String, String> {
    let failed = |cause: std::io::Error| format!("{}: {cause}", folder.display());
    let mut rows = [("wasm", Weight::NONE), ("page", Weight::NONE), ("all", Weight::NONE)];
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let weight = Weight::of(&std::fs::read(&path).map_err(failed)?).map_err(failed)?;
        let is_wasm = path.extension().is_some_and(|e| e == "wasm");
        rows[usize::from(!is_wasm)].1.add(&weight);
        rows[2].1.add(&weight);
    }
    let lines = rows.iter().map(|(name, w)| format!("{name:6} {:>10} {:>10} {:>10}", w.raw, w.gzip, w.brotli));
    let heading = format!("{:6} {:>10} {:>10} {:>10}", "bytes", "raw", "gzip", "brotli");
    Ok([heading].into_iter().chain(lines).collect::<Vec<_>>().join("\n"))
}

impl Weight {
    const NONE: Self = Self { raw: 0, gzip: 0, brotli: 0 };

    fn of(bytes: &[u8]) -> std::io::Result<Self> {
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        gzip.write_all(bytes)?;
        let mut brotli = Vec::new();
        let parameters = brotli::enc::BrotliEncoderParams { quality: 9, ..Default::default() };
        brotli::BrotliCompress(&mut &*bytes, &mut brotli, &parameters)?;
        Ok(Self { raw: bytes.len(), gzip: gzip.finish()?.len(), brotli: brotli.len() })
    }

    fn add(&mut self, other: &Self) {
        self.raw += other.raw;
        self.gzip += other.gzip;
        self.brotli += other.brotli;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_weighed_three_ways() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.wasm"), [7; 1000]).unwrap();
        std::fs::write(folder.path().join("b.js"), "x".repeat(500)).unwrap();
        let text = table(folder.path()).unwrap();
        let numbers = |line: usize| -> Vec<usize> {
            text.lines().nth(line).unwrap().split_whitespace().skip(1).map(|n| n.parse().unwrap()).collect()
        };
        assert_eq!((numbers(1)[0], numbers(2)[0], numbers(3)[0]), (1000, 500, 1500));
        assert!(numbers(3)[1] < 200 && numbers(3)[2] < 200);
    }
}
