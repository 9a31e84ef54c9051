"""The columns of a campaign's table."""

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from recordings.limits import figure_kinds
from sim.campaign.columns import schema, write_table
from sim.campaign.executor import Loss, Lost
from sim.campaign.row import RowMaker
from sim.campaign.variation import parse_variations


@pytest.mark.parametrize(
    ("values", "kind", "found"),
    [
        ("0,3", pa.int64(), 3),
        ("0,3.5", pa.float64(), 3.5),
        ("true,false", pa.bool_(), False),
        ('staged,"wind aware"', pa.string(), "wind aware"),
        ("1,true", pa.string(), "true"),
        ("never,{a = 1}", pa.string(), "{a = 1}"),
        ("2022-09-29T00:00:00Z,2022-09-30T00:00:00Z", pa.string(), "2022-09-30T00:00:00Z"),
    ],
)
def test_what_is_varied_is_a_column_of_its_kind(hop, tmp_path, values, kind, found):
    (varied,) = parse_variations([f"a.b={values}"])
    columns = schema([varied], {"x": "y"})
    assert columns.field("vary.a.b").type == kind
    rows = [
        RowMaker(hop(override, run=run)).lost(Lost(Loss.TIMED_OUT, "late"))
        for run, override in enumerate(varied.overrides)
    ]
    write_table(tmp_path / "x.parquet", rows, columns, {1: "recordings/x.mcap"})
    table = pq.read_table(tmp_path / "x.parquet")
    assert table["vary.a.b"].to_pylist()[1] == found
    assert table["recording"].to_pylist() == [None, "recordings/x.mcap"]
    assert table["cross_track_m.p95"].to_pylist() == [None, None]
    assert table.schema.metadata[b"x"] == b"y"
    assert set(figure_kinds()) < set(table.column_names)


def test_a_table_that_cannot_be_written_leaves_the_one_before(hop, tmp_path):
    path = tmp_path / "x.parquet"
    row = RowMaker(hop()).lost(Lost(Loss.TIMED_OUT, "late"))
    write_table(path, [row], schema([], {}), {})
    before = path.read_bytes()

    def breaks():
        yield row
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        write_table(path, breaks(), schema([], {}), {})
    assert path.read_bytes() == before
