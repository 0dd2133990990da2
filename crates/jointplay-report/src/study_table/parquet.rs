//! A study's table as Parquet: chunks are encoded independently, and the footer lists their offsets.

use std::sync::Arc;

use jointplay_study::plan::Block;
use parquet::arrow::add_encoded_arrow_schema_to_metadata;
use parquet::basic::{Compression, ConvertedType, Encoding, Repetition, Type};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::metadata::{
    ColumnChunkMetaData, KeyValue, ParquetMetaData, ParquetMetaDataOptions, ParquetMetaDataReader,
    ParquetMetaDataWriter, RowGroupMetaData,
};
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesPtr};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type as Schematic, TypePtr};

use super::arrow::arrow_schema;
use super::compact_struct::is_compact_struct;
use super::value::{Values, values};
use crate::table_error::TableError;
use jointplay_format::study::{Column, Source};

/// First and last bytes of a file.
pub(super) const MAGIC: &[u8; 4] = b"PAR1";
/// Length of the end of a file: length of the footer, and magic number (bytes).
const TAIL: usize = 8;

/// Metadata of one chunk.
pub(super) type Group = RowGroupMetaData;

/// Columns and writer properties.
pub(super) struct Schema {
    schema: TypePtr,
    properties: WriterPropertiesPtr,
    /// Metadata of an empty file.
    empty: ParquetMetaData,
}

impl Schema {
    pub(super) fn new(columns: &[Column]) -> Result<Self, TableError> {
        let mut fields = Vec::with_capacity(columns.len());
        // Numbers hardly ever repeat; repeated values are worth a dictionary.
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("jointplay ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_offset_index_disabled(true)
            .set_key_value_metadata(Some(vec![units(columns)]))
            .set_dictionary_enabled(false);
        for column in columns {
            let path = || ColumnPath::new(vec![column.name.clone()]);
            let (physical, converted) = match column.source {
                Source::Sample | Source::Draw => (Type::INT64, ConvertedType::NONE),
                Source::Number { .. } => (Type::DOUBLE, ConvertedType::NONE),
                Source::Status { .. } => (Type::BYTE_ARRAY, ConvertedType::UTF8),
            };
            let field = Schematic::primitive_type_builder(&column.name, physical)
                .with_repetition(Repetition::REQUIRED)
                .with_converted_type(converted)
                .build()?;
            fields.push(Arc::new(field));
            properties = match column.source {
                Source::Sample => {
                    properties.set_column_encoding(path(), Encoding::DELTA_BINARY_PACKED)
                }
                Source::Number { repeats: false, .. } => properties,
                _ => properties.set_column_dictionary_enabled(path(), true),
            };
        }
        let schema = Schematic::group_type_builder("samples").with_fields(fields).build()?;
        let mut properties = properties.build();
        // Units of columns again, for readers of Arrow.
        add_encoded_arrow_schema_to_metadata(&arrow_schema(columns), &mut properties);
        let (schema, properties) = (Arc::new(schema), Arc::new(properties));
        let writer =
            SerializedFileWriter::new(Vec::new(), Arc::clone(&schema), Arc::clone(&properties))?;
        let empty = writer.close()?;
        Ok(Self { schema, properties, empty })
    }

    /// Encodes a chunk as a file of its own.
    pub(super) fn encode(
        &self,
        columns: &[Column],
        blocks: &[Block],
    ) -> Result<(Vec<u8>, Group), TableError> {
        let mut bytes = Vec::new();
        let (schema, properties) = (Arc::clone(&self.schema), Arc::clone(&self.properties));
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties)?;
        let mut group = writer.next_row_group()?;
        for column in columns {
            write(&mut group, column, blocks)?;
        }
        group.close()?;
        writer.close()?;
        // Read back from the written bytes: a resumed study has only these.
        let (chunk, group) = self.chunk_of(&bytes)?;
        let end = MAGIC.len() + chunk.len();
        bytes.truncate(end);
        bytes.drain(..MAGIC.len());
        Ok((bytes, group))
    }

    /// The end of a file with these chunks.
    pub(super) fn foot(&self, groups: &[Group]) -> Result<Vec<u8>, TableError> {
        let metadata = self.empty.file_metadata();
        let rows = groups.iter().try_fold(0_i64, |sum, group| sum.checked_add(group.num_rows()));
        let rows = rows.ok_or(TableError::Footer)?;
        let file = parquet::file::metadata::FileMetaData::new(
            metadata.version(),
            rows,
            metadata.created_by().map(str::to_owned),
            metadata.key_value_metadata().cloned(),
            metadata.schema_descr_ptr(),
            metadata.column_orders().cloned(),
        );
        let mut bytes = Vec::new();
        let metadata = ParquetMetaData::new(file, groups.to_vec());
        ParquetMetaDataWriter::new(&mut bytes, &metadata).finish()?;
        Ok(bytes)
    }

    /// The bytes and the metadata of the chunk of a file with one.
    pub(super) fn chunk_of<'f>(&self, file: &'f [u8]) -> Result<(&'f [u8], Group), TableError> {
        let mut groups = self.groups(file)?;
        let group = groups.pop().filter(|_| groups.is_empty()).ok_or(TableError::Footer)?;
        let ends = group.columns().iter().map(end_of).collect::<Result<Vec<_>, _>>()?;
        let end = ends.into_iter().max().unwrap_or_default();
        let chunk = file.get(MAGIC.len()..end).ok_or(TableError::Footer)?;
        Ok((chunk, group))
    }

    /// Metadata of the chunks from the end of a file with these columns.
    pub(super) fn groups(&self, foot: &[u8]) -> Result<Vec<Group>, TableError> {
        let broken = || TableError::Footer;
        let (metadata, tail) = foot.split_last_chunk::<TAIL>().ok_or_else(broken)?;
        let (length, magic) = tail.split_at(4);
        let length = u32::from_le_bytes(length.try_into().map_err(|_| broken())?);
        let length = usize::try_from(length).map_err(|_| broken())?;
        let start =
            metadata.len().checked_sub(length).filter(|_| magic == MAGIC).ok_or_else(broken)?;
        let metadata = &metadata[start..];
        // The library reserves memory for, and spends time on, as many elements as a list states.
        if !is_compact_struct(metadata) {
            return Err(broken());
        }
        // With its own schema: that of the file may be nested as deeply as it is long.
        let schema = self.empty.file_metadata().schema_descr_ptr();
        let options = ParquetMetaDataOptions::new().with_schema(schema);
        let file = ParquetMetaDataReader::decode_metadata_with_options(metadata, Some(&options))
            .map_err(|_| broken())?;
        // Positions remain; only the ordinals that reading adds are removed.
        file.row_groups().iter().map(|group| placed(group, MAGIC.len() as u64)).collect()
    }
}

/// Where the bytes of a column end in the file.
fn end_of(column: &ColumnChunkMetaData) -> Result<usize, TableError> {
    let start = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
    let end = start.checked_add(column.compressed_size());
    let end = end.filter(|_| start >= 0 && column.compressed_size() >= 0);
    end.and_then(|end| usize::try_from(end).ok()).ok_or(TableError::Footer)
}

/// Units of the columns as metadata of the file: a JSON object.
fn units(columns: &[Column]) -> KeyValue {
    let units = columns.iter().filter_map(|column| {
        let Source::Number { unit, .. } = column.source else { return None };
        Some((column.name.clone(), unit.code()?.into()))
    });
    let units: serde_json::Map<String, serde_json::Value> = units.collect();
    KeyValue::new("units".to_owned(), serde_json::Value::from(units).to_string())
}

/// Writes one column of a chunk.
fn write(
    group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>,
    column: &Column,
    blocks: &[Block],
) -> Result<(), TableError> {
    let mut target = group.next_column()?.ok_or(TableError::Encoding)?;
    for block in blocks {
        match values(column, block) {
            Values::Counts(counts) => {
                target.typed::<Int64Type>().write_batch(&counts, None, None)?;
            }
            Values::Numbers(numbers) => {
                target.typed::<DoubleType>().write_batch(&numbers, None, None)?;
            }
            Values::Words(words) => {
                let words: Vec<ByteArray> = words.into_iter().map(ByteArray::from).collect();
                target.typed::<ByteArrayType>().write_batch(&words, None, None)?;
            }
        }
    }
    Ok(target.close()?)
}

/// A chunk's metadata with the chunk at byte `at` of the file.
pub(super) fn placed(group: &Group, at: u64) -> Result<Group, TableError> {
    let by = i64::try_from(at).map_err(|_| TableError::Encoding)? - MAGIC.len() as i64;
    let moved = |offset: i64| offset.checked_add(by).ok_or(TableError::Footer);
    let columns = group
        .columns()
        .iter()
        .map(|column| {
            let dictionary = column.dictionary_page_offset().map(moved).transpose()?;
            let column = column
                .clone()
                .into_builder()
                .set_data_page_offset(moved(column.data_page_offset())?)
                .set_dictionary_page_offset(dictionary);
            Ok(column.build()?)
        })
        .collect::<Result<Vec<_>, TableError>>()?;
    // Without an ordinal, which counts to 32767 only.
    let mut placed = Group::builder(group.schema_descr_ptr())
        .set_num_rows(group.num_rows())
        .set_total_byte_size(group.total_byte_size())
        .set_column_metadata(columns);
    if let Some(offset) = group.file_offset() {
        placed = placed.set_file_offset(moved(offset)?);
    }
    Ok(placed.build()?)
}
