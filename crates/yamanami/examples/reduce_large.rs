//! Reduces a mesh in bounded memory: `reduce_large INPUT OUTPUT RATIO MEGABYTES`.

use std::path::Path;
use yamanami::{LargeOptions, LargeTarget, reduce_large};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let [_, input, output, ratio, megabytes] = &args[..] else {
        return Err("reduce_large INPUT OUTPUT RATIO MEGABYTES".into());
    };
    let memory_bytes = megabytes.parse::<u64>()? * 1_000_000;
    let options = LargeOptions::new(LargeTarget::Ratio(ratio.parse()?), memory_bytes);
    let start = std::time::Instant::now();
    let report = reduce_large(Path::new(input), Path::new(output), &options, &|share| {
        eprintln!("{:7.2} s {:5.1} %", start.elapsed().as_secs_f64(), share * 100.0);
    })?;
    println!("{:.2} s {report:?}", start.elapsed().as_secs_f64());
    Ok(())
}
