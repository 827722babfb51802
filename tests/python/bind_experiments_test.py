import unittest

import pleat
import take


class ExperimentTest(unittest.TestCase):
    def test_the_comparison_of_learners_says_what_details_add(self):
        rows = pleat.experiment(take.performer(), "full-vs-fine", paper_options=False, protocol="every5th")
        self.assertGreater(len(rows), 1)
        for row in rows:
            report = row["report"]
            self.assertEqual(report["protocol"], "every5th")
            self.assertGreater(report["errors"]["hybrid"]["mean_percent"], 0)
            self.assertEqual(len(report["errors"]["hybrid"]["frame_mean_percent"]), len(report["test_frames"]))

    def test_unknown_names_are_errors(self):
        self.assertIn("resolutions", pleat.experiment_names())
        with self.assertRaisesRegex(pleat.Error, "resolutions"):
            pleat.experiment(take.performer(), "no such")
        with self.assertRaisesRegex(pleat.Error, "every5th"):
            pleat.experiment(take.performer(), "resolutions", protocol="no such")


if __name__ == "__main__":
    unittest.main()
