//! Random numbers that depend on nothing but seed, quantity and draw.

use chacha20::ChaCha20Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

/// Numbers of the random streams; dimensions follow, four for each limb.
pub(super) const HEIGHT_STREAM: u64 = 0;
pub(super) const FIRST_STREAM: u64 = 1;
pub(super) const SECOND_STREAM: u64 = 2;
/// Streams of the parameters of mechanisms, by their number in the file, and of commanded coordinates.
pub(super) const PARAMETER_STREAMS: u64 = 1 << 32;
pub(super) const DRIVE_STREAMS: u64 = 2 << 32;
/// Streams of the values of sweeps, by their numbers.
pub(super) const SWEEP_STREAMS: u64 = 3 << 32;
/// Stream of the first dimension of the first limb.
pub(super) const DIMENSION_STREAMS: u64 = 3;

/// 32-bit words of the keystream that one draw of one quantity takes.
const WORDS: u128 = 4;

/// The draws of one quantity, in whatever order they are asked for.
///
/// Draw j is made of bytes 16 j to 16 j + 15 of the ChaCha20 keystream whose key is the seed as eight bytes, the least first, and 24 zeros, and whose nonce of eight bytes is the number of the quantity.
/// So neither another quantity that is drawn, nor chunks, threads or a run taken up again change a draw.
///
/// # Source
/// \[ChaCha\]
pub(super) struct Stream {
    keystream: ChaCha20Rng,
    next: Option<u64>,
}

impl Stream {
    /// The stream of a quantity.
    pub(super) fn new(seed: u64, quantity: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut keystream = ChaCha20Rng::from_seed(key);
        keystream.set_stream(quantity);
        Self { keystream, next: None }
    }

    /// The 16 bytes of a draw, as two whole numbers.
    fn pair(&mut self, draw: u64) -> [u64; 2] {
        if self.next != Some(draw) {
            self.keystream.set_word_pos(u128::from(draw) * WORDS);
        }
        self.next = draw.checked_add(1);
        [self.keystream.next_u64(), self.keystream.next_u64()]
    }

    /// Uniform in 0…1 without 1, a multiple of 2⁻⁵³.
    pub(super) fn uniform(&mut self, draw: u64) -> f64 {
        fraction(self.pair(draw)[0])
    }

    /// Normal with mean 0 and standard deviation 1, at most 8.6 from 0.
    ///
    /// ```text
    ///    √(−2 ln u_1) cos(2π u_2)        u_1 in 0…1 without 0, u_2 in 0…1 without 1
    /// ```
    /// # Source
    /// \[BoxMuller\]
    pub(super) fn normal(&mut self, draw: u64) -> f64 {
        let [first, second] = self.pair(draw);
        let radius = (-2.0 * libm::log(1.0 - fraction(first))).sqrt();
        radius * libm::cos(std::f64::consts::TAU * fraction(second))
    }
}

/// The upper 53 bits as a fraction.
fn fraction(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Made by `head -c 64 /dev/zero | openssl enc -chacha20 -K 07<62 zeros> -iv 0000000000000000 0200000000000000`:
    /// seed 7, quantity 2, draws 0 to 3.
    const OPENSSL: [u8; 64] = [
        0x41, 0x02, 0xf9, 0x12, 0xa5, 0xa8, 0xce, 0x2b, 0xf2, 0xd3, 0x8d, 0x51, 0xc9, 0x7a, 0xea,
        0xf4, 0xcd, 0xce, 0xd5, 0xb7, 0xb4, 0xe9, 0x41, 0xf9, 0x46, 0x8a, 0xab, 0x82, 0x20, 0xd4,
        0x4b, 0xd5, 0xbf, 0x15, 0xd0, 0x42, 0xa7, 0xd2, 0xfc, 0xed, 0xb1, 0x90, 0xa8, 0x0a, 0x68,
        0xb1, 0x36, 0x7a, 0x06, 0x99, 0xbc, 0x49, 0x32, 0x5c, 0x3e, 0x60, 0x71, 0xce, 0x71, 0x39,
        0x58, 0x2e, 0xe4, 0xdf,
    ];

    fn expected(draw: usize) -> [u64; 2] {
        [0, 8].map(|start| {
            let start = 16 * draw + start;
            u64::from_le_bytes(OPENSSL[start..start + 8].try_into().unwrap())
        })
    }

    #[test]
    fn draws_are_those_of_another_program() {
        let mut stream = Stream::new(7, 2);
        for draw in [0, 1, 2, 3, 1, 3, 0, 2] {
            assert_eq!(stream.pair(draw as u64), expected(draw), "draw {draw}");
        }
        assert_eq!(stream.uniform(0), (expected(0)[0] >> 11) as f64 * 2_f64.powi(-53));
    }

    #[test]
    fn far_draws_are_found() {
        // `-iv` with the block counter 2⁶² − 1 in its first eight bytes: draws 2⁶⁴ − 4 to 2⁶⁴ − 1 of quantity 1, seed 0.
        let mut stream = Stream::new(0, 1);
        let last = stream.pair(u64::MAX);
        assert_eq!(stream.pair(u64::MAX), last);
        assert_eq!(last, [0x86735267b741d6d4, 0x8618cfe3adebcfc1]);
    }

    #[test]
    fn normal_draws_have_their_moments() {
        let mut stream = Stream::new(1, 0);
        let draws: Vec<f64> = (0..200_000).map(|draw| stream.normal(draw)).collect();
        let moment = |power: i32| {
            draws.iter().map(|draw| draw.powi(power)).sum::<f64>() / draws.len() as f64
        };
        // Four standard errors of each mean.
        for (power, expected, variance) in
            [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)]
        {
            let slack = 4.0 * (variance / draws.len() as f64).sqrt();
            assert!((moment(power) - expected).abs() < slack, "moment {power}: {}", moment(power));
        }
    }
}
