//! Numbers of pages as rows of a table, and checksums of rows.

use yamanami_core::PageId;

/// Row number of a page: coarse levels first, then by rows.
pub fn row_id(id: PageId) -> i64 {
    i64::from(63 - id.level) << 48 | i64::from(id.y) << 24 | i64::from(id.x)
}

/// The page of a row number.
pub fn page_id(row: i64) -> Option<PageId> {
    let field = |shift: u32| (row >> shift & 0xFF_FFFF) as u32;
    let level = 63u32.checked_sub(u32::try_from(row >> 48).ok()?)?;
    Some(PageId { level, x: field(0), y: field(24) })
}

/// Checksum of a row: CRC-32 of its number (8 bytes, little-endian) and its bytes.
pub fn row_crc32(row: i64, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&row.to_le_bytes());
    hasher.update(bytes);
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_numbers_go_from_coarse_to_fine_and_back() {
        let ids = [(30, 0, 0), (3, 5, 0), (3, 0, 1), (0, 0xFF_FFFF, 2), (0, 0, 3)];
        let ids = ids.map(|(level, x, y)| PageId { level, x, y });
        assert!(ids.windows(2).all(|w| row_id(w[0]) < row_id(w[1])));
        assert!(ids.iter().all(|&id| page_id(row_id(id)) == Some(id)));
        assert_eq!(page_id(-1), None);
    }
}
