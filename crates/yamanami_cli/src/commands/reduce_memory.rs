//! `reduce --memory`: a model that may be larger than memory, and what is told of it.

use super::reduce::ReduceArgs;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out, text};
use serde_json::json;
use std::time::Instant;
use yamanami::io::mesh_file::MeshMeta;
use yamanami::multires::collapse::StoppedBy;
use yamanami::{LargeOptions, LargeReport, LargeTarget, reduce_large};

/// Reduces within a memory.
pub(super) fn run(args: &ReduceArgs, target: LargeTarget, memory_bytes: u64) -> Result<(), Failure> {
    let name = args.mesh.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let options = LargeOptions {
        method: args.method.method(),
        meta: MeshMeta { note: format!("reduced from {name}; yamanami"), ..MeshMeta::default() },
        ..LargeOptions::new(target, memory_bytes)
    };
    let started = Instant::now();
    let report = {
        let bar = Bar::shares("reducing");
        reduce_large(&args.mesh, &args.output, &options, &|share| bar.set_share(share))?
    };
    let seconds = started.elapsed().as_secs_f64();
    let bytes = inputs::file_bytes(&args.output)?;
    if args.json {
        return out::json(&json!({
            "output": args.output,
            "source_faces": report.source_faces,
            "target_faces": report.target_faces,
            "faces": report.faces,
            "stopped_by": match report.stopped_by {
                StoppedBy::Target => "target",
                StoppedBy::Error => "error",
                StoppedBy::Topology => "topology",
            },
            "memory_bytes": memory_bytes,
            "peak_bytes": peak_bytes(),
            "blocks": report.blocks,
            "seam_faces": report.seam_faces,
            "joined_faces": report.joined_faces,
            "scratch_bytes": report.scratch_bytes,
            "left_out": report.left_out,
            "reduce_s": seconds,
            "bytes": bytes,
        }));
    }
    as_text(args, &report, memory_bytes, seconds, bytes)
}

fn as_text(
    args: &ReduceArgs,
    report: &LargeReport,
    memory_bytes: u64,
    seconds: f64,
    bytes: u64,
) -> Result<(), Failure> {
    let count = |n: u64| text::count(n);
    out::row("source", format_args!("{} faces", count(report.source_faces)))?;
    out::row("target", format_args!("{} faces", count(report.target_faces)))?;
    if report.blocks.is_empty() {
        out::row("blocks", "none: it fits into memory as a whole")?;
    }
    for &blocks in &report.blocks {
        out::row("blocks", count(blocks as u64))?;
    }
    if !report.blocks.is_empty() {
        out::row("joined", format_args!("{} faces, reduced once more as a whole", count(report.joined_faces)))?;
        out::row("scratch", format_args!("{} on the disk, given back", text::bytes(report.scratch_bytes)))?;
    }
    if !report.left_out.is_empty() {
        out::row("left out", format_args!("{}, which do not pass through blocks", report.left_out.join(" and ")))?;
    }
    let share = 100.0 * report.faces as f64 / report.source_faces.max(1) as f64;
    out::row("result", format_args!("{} faces ({} %)", count(report.faces), text::number(share)))?;
    out::row(
        "ended by",
        match report.stopped_by {
            StoppedBy::Target => "the faces wanted",
            StoppedBy::Error => "the error allowed",
            StoppedBy::Topology => "the surface: no edge is left that may go without harm",
        },
    )?;
    let peak = peak_bytes().map_or_else(String::new, |peak| format!("{} at most, of ", text::bytes(peak)));
    out::row("memory", format_args!("{peak}{} allowed", text::bytes(memory_bytes)))?;
    out::row("time", format_args!("{} s with reading and writing", text::number(seconds)))?;
    out::row("mesh file", format_args!("{}, {}", args.output.display(), text::bytes(bytes)))
}

/// The most memory that this process ever held, where the system tells.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
