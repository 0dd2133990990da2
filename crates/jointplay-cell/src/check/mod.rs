//! What is wrong with a motion.
