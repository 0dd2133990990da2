//! Pictures of mechanisms: links, joints by kind, and actuators.
//!
//! | file | role |
//! | --- | --- |
//! | `picture.rs` | the picture as data |
//! | `scene.rs` | links and joints in space, moved apart where they coincide |
//! | `view.rs`, `camera.rs` | the viewing direction, and the projection onto the page |
//! | `glyph.rs`, `plate.rs`, `item.rs` | shapes of joints and links |
//! | `paint.rs`, `order.rs` | all shapes, drawn from far to near |
//! | `labels.rs`, `page.rs` | names, axes, scale and legend |
//! | `render.rs` | the picture as SVG and PNG |

mod camera;
mod glyph;
mod item;
mod labels;
mod order;
mod page;
mod paint;
mod picture;
mod plate;
mod render;
mod scene;
mod view;

pub use picture::{Labels, MechanismPicture};
pub use view::View;
